#include "recollect/geometry/trajectory.h"

#include <algorithm>

#include "recollect/core/error.h"

namespace recollect {

Trajectory::Trajectory(std::vector<StampedPose> poses) : poses_(std::move(poses)) {
  for (std::size_t i = 1; i < poses_.size(); ++i) {
    Require(poses_[i].time > poses_[i - 1].time, "trajectory",
            fmt::format("pose {} at {} s is not after the one before at {} s", i, poses_[i].time,
                        poses_[i - 1].time));
  }
}

bool Trajectory::Covers(double time) const {
  return !poses_.empty() && time >= poses_.front().time && time <= poses_.back().time;
}

SE3 Trajectory::At(double time) const {
  Require(!poses_.empty(), "trajectory", "has no pose");
  Require(
      Covers(time), "trajectory",
      fmt::format("{} s is outside its {} to {} s", time, poses_.front().time, poses_.back().time));
  const auto after =
      std::upper_bound(poses_.begin(), poses_.end(), time,
                       [](double wanted, const StampedPose& pose) { return wanted < pose.time; });
  const auto before = after - 1;
  if (after == poses_.end()) return before->world_from_body;
  return Interpolate(before->world_from_body, after->world_from_body,
                     (time - before->time) / (after->time - before->time));
}

double Trajectory::Length() const {
  double length = 0;
  for (std::size_t i = 1; i < poses_.size(); ++i) {
    length +=
        (poses_[i].world_from_body.translation() - poses_[i - 1].world_from_body.translation())
            .norm();
  }
  return length;
}

}  // namespace recollect
