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
  double time = 0;      // seconds; the zero is the data set's own
  SE3 world_from_body;  // metres; axes of the world as in the data set, see Lap::world_up
  std::filesystem::path left, right, depth;
};

// A satellite position of the body, in the frame of the poses. Quality as in NMEA's GGA: 4 RTK
// fixed, 5 RTK float, 2 differential, 1 plain, 0 none (p_world is then worthless).
struct GpsFix {
  double time = 0;
  Eigen::Vector3d p_world = Eigen::Vector3d::Zero();
  int quality = 0;
};

// One drive of a route with one camera. The body is what the poses belong to: a camera (KITTI:
// camera 0; TUM: the camera itself; x right, y down, z forward) or the car (UFES-LAPS: x forward,
// y left, z up).
struct Lap {
  std::string name;
  std::filesystem::path folder;
  StereoCamera camera;  // all zero where the data set has poses only
  SE3 body_from_camera;
  Eigen::Vector3d body_forward = Eigen::Vector3d::UnitZ();  // the axis that points ahead
  // Up in the world's axes, or zero where the format does not say: KITTI's world is its first
  // camera in the odometry benchmark (y down), and a map's (z up) elsewhere.
  Eigen::Vector3d world_up = Eigen::Vector3d::Zero();
  int world = 0;             // poses of laps with different numbers here have nothing in common
  double depth_unit = 0.01;  // metres a step of the depth images
  std::vector<Frame> frames;
  std::vector<GpsFix> gps;  // in order of time; empty where there is none

  SE3 WorldFromCamera(std::size_t frame) const {
    return frames[frame].world_from_body * body_from_camera;
  }
};

// The unit vector in which the body points at `frame`, in world axes: with world_up known its
// horizontal part, so that headings differ by yaw (UFES-LAPS: by rz exactly), otherwise as it is.
Eigen::Vector3d Heading(const Lap& lap, std::size_t frame);

// Angle in [0, pi] between two headings.
double HeadingDifference(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

// The lap with only `frames` of it, in that order; the satellite fixes stay.
Lap Subset(const Lap& lap, const std::vector<std::size_t>& frames);

// Sum of the distances from frame to frame, metres.
double PathLength(const Lap& lap);

// The satellite fix nearest in time to `time`, nullptr where the lap has none at all. It may be of
// quality 0, and far off in time where reception was lost.
const GpsFix* NearestFix(const Lap& lap, double time);

// The camera of a depth image of width x height pixels that belongs to an image of `camera`: the
// same, or every n-th pixel of every n-th row (pixel (i, j) is then (n i, n j) of the image).
// Throws Error naming `where` when the size is no such whole fraction.
PinholeCamera DepthCamera(const PinholeCamera& camera, int width, int height,
                          const std::string& where = "depth");

}  // namespace recollect
