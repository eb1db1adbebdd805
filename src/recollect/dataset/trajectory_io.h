#pragma once

#include <filesystem>
#include <vector>

#include "recollect/geometry/trajectory.h"

namespace recollect {

// Reading throws Error, naming file and line, for rows of the wrong length, for what is no finite
// number or no rigid motion (rounding is removed), for times out of order and for a file without
// any pose. Writing is whole or not at all (AtomicWrite) and gives every bit back when read.

// TUM: "time tx ty tz qx qy qz qw" a row, seconds and metres.
Trajectory ReadTumTrajectory(const std::filesystem::path& path);
void WriteTumTrajectory(const std::filesystem::path& path, const std::vector<StampedPose>& poses);

// KITTI: a 3x4 matrix a row, row-major, metres.
std::vector<SE3> ReadKittiPoses(const std::filesystem::path& path);
void WriteKittiPoses(const std::filesystem::path& path, const std::vector<SE3>& poses);

}  // namespace recollect
