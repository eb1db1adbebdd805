#include "recollect/dataset/lap.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "recollect/core/error.h"

namespace recollect {

Eigen::Vector3d Heading(const Lap& lap, std::size_t frame) {
  const Eigen::Vector3d ahead = lap.frames[frame].world_from_body.rotation() * lap.body_forward;
  return (ahead - ahead.dot(lap.world_up) * lap.world_up).normalized();
}

double HeadingDifference(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

Lap Subset(const Lap& lap, const std::vector<std::size_t>& frames) {
  Lap subset = lap;
  subset.frames.clear();
  subset.frames.reserve(frames.size());
  for (const std::size_t frame : frames) subset.frames.push_back(lap.frames.at(frame));
  return subset;
}

double PathLength(const Lap& lap) {
  double length = 0;
  for (std::size_t i = 1; i < lap.frames.size(); ++i) {
    length += (lap.frames[i].world_from_body.translation() -
               lap.frames[i - 1].world_from_body.translation())
                  .norm();
  }
  return length;
}

const GpsFix* NearestFix(const Lap& lap, double time) {
  if (lap.gps.empty()) return nullptr;
  const auto after =
      std::lower_bound(lap.gps.begin(), lap.gps.end(), time,
                       [](const GpsFix& fix, double wanted) { return fix.time < wanted; });
  if (after == lap.gps.begin()) return &*after;
  const auto before = after - 1;
  return after != lap.gps.end() && after->time - time < time - before->time ? &*after : &*before;
}

PinholeCamera DepthCamera(const PinholeCamera& camera, int width, int height,
                          const std::string& where) {
  for (int step = 1; width > 0 && height > 0 && step <= camera.width; ++step) {
    const PinholeCamera candidate = camera.Subsampled(step);
    if (candidate.width == width && candidate.height == height) return candidate;
  }
  throw Error(where, fmt::format("{}x{} is no whole fraction of the {}x{} image", width, height,
                                 camera.width, camera.height));
}

}  // namespace recollect
