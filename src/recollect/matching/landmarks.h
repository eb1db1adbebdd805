#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "recollect/geometry/camera.h"

namespace recollect::matching {

// A point of a key frame that can be found again, with where it is in space.
struct Landmark {
  Eigen::Vector3d p_keyframe;  // metres, in the key frame's camera
  double pixel_sigma = 1;      // of its place in the key frame, pixels
  double depth_sigma = 0;      // along the ray, metres

  // Of p_keyframe, in the key frame's camera.
  Eigen::Matrix3d Covariance(const PinholeCamera& camera) const;
};

// What a map keeps of a key frame's geometry.
struct Landmarks {
  std::vector<Landmark> points;
  std::vector<std::int8_t> descriptors;  // kDescriptorBytes each
  std::vector<int> sources;  // frames of the lap whose images this was made of, the key frame first
  int size() const { return static_cast<int>(points.size()); }
};

// As bytes, at most 148 a landmark, and back. FromBytes throws Error naming `where` on anything but
// what ToBytes wrote.
std::vector<std::byte> ToBytes(const Landmarks& landmarks);
Landmarks LandmarksFromBytes(std::span<const std::byte> bytes, const std::string& where);

}  // namespace recollect::matching
