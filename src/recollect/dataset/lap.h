#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "recollect/geometry/camera.h"
#include "recollect/geometry/se3.h"

namespace recollect {

// One moment of a drive. Paths are empty where the data set brings no such image.
struct Frame {
  double time = 0;        // seconds; the zero is the data set's own
  SE3 world_from_body;    // metres; world z up where the data set says so
  std::filesystem::path left, right, depth;
};

// A satellite position, in the frame of the poses. Quality as in NMEA's GGA: 4 RTK fixed, 5 RTK
// float, 2 differential, 1 plain, 0 none (p_world is then worthless).
struct GpsFix {
  double time = 0;
  Eigen::Vector3d p_world = Eigen::Vector3d::Zero();
  int quality = 0;
};

// One drive of a route with one camera. The body is what the poses belong to: the left camera
// itself (KITTI, TUM) or the car (UFES-LAPS: x forward, y left, z up).
struct Lap {
  std::string name;
  std::filesystem::path folder;
  StereoCamera camera;
  SE3 body_from_camera;
  std::vector<Frame> frames;
  std::vector<GpsFix> gps;  // in order of time; empty where there is none

  SE3 WorldFromCamera(std::size_t frame) const {
    return frames[frame].world_from_body * body_from_camera;
  }
};

}  // namespace recollect
