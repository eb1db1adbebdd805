#pragma once

#include <cstddef>
#include <vector>

#include "recollect/geometry/se3.h"

namespace recollect {

struct StampedPose {
  double time = 0;  // seconds
  SE3 world_from_body;
};

// Poses in order of time, and the motion between them.
class Trajectory {
 public:
  Trajectory() = default;
  // Throws Error unless each time is after the one before.
  explicit Trajectory(std::vector<StampedPose> poses);

  const std::vector<StampedPose>& poses() const { return poses_; }
  std::size_t size() const { return poses_.size(); }
  bool Covers(double time) const;

  // The pose at `time`: between two poses each of rotation and translation goes at even speed along
  // its shortest way. Throws Error for a time outside the trajectory.
  SE3 At(double time) const;

  // Sum of the distances from pose to pose, metres.
  double Length() const;

 private:
  std::vector<StampedPose> poses_;
};

}  // namespace recollect
