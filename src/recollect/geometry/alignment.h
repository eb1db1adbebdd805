#pragma once

#include <Eigen/Core>
#include <vector>

#include "recollect/geometry/se3.h"

namespace recollect {

// p_target = scale * R * p_source + t, with (R, t) in `motion`.
struct Similarity {
  double scale = 1;
  SE3 motion;

  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return motion * (scale * p); }
  // A pose of the source world in the target's: moved, its rotation not scaled.
  SE3 operator*(const SE3& pose) const {
    return {motion.rotation() * pose.rotation(), *this * pose.translation()};
  }
};

// The similarity (or, with scale kept at 1, the rigid motion) that brings `source` onto `target`
// with the least sum of squared distances: Umeyama, "Least-squares estimation of transformation
// parameters between two point patterns" (PAMI 1991), eq. 34-43. Points of one index belong
// together. Throws Error for sets of different sizes and for points that leave the rotation open
// (all in one line, or fewer than three).
Similarity AlignPoints(const std::vector<Eigen::Vector3d>& source,
                       const std::vector<Eigen::Vector3d>& target, bool with_scale);

// The same for the positions of poses.
Similarity AlignPoses(const std::vector<SE3>& source, const std::vector<SE3>& target,
                      bool with_scale);

}  // namespace recollect
