#include "recollect/dataset/trajectory_io.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <string>

#include "recollect/core/error.h"
#include "recollect/core/files.h"
#include "recollect/dataset/text_table.h"

namespace recollect {
namespace {

using RowMajor34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

}  // namespace

Trajectory ReadTumTrajectory(const std::filesystem::path& path) {
  const TextTable table(path);
  std::vector<StampedPose> poses;
  for (const TextTable::Row& row : table.rows()) {
    table.RequireFields(row, 8, "time tx ty tz qx qy qz qw");
    const std::array<double, 8> v = table.Numbers<8>(row);
    const Eigen::Quaterniond q(v[7], v[4], v[5], v[6]);
    if (std::abs(q.norm() - 1) > 0.01) table.Fail(row, "the quaternion is not of length 1");
    if (!poses.empty()) table.RequireAfter(row, poses.back().time, v[0]);
    poses.push_back({v[0], SE3(q.normalized().toRotationMatrix(), {v[1], v[2], v[3]})});
  }
  Require(!poses.empty(), path.string(), "holds no pose");
  return Trajectory(std::move(poses));
}

void WriteTumTrajectory(const std::filesystem::path& path, const std::vector<StampedPose>& poses) {
  std::string text;
  for (const StampedPose& pose : poses) {
    const Eigen::Vector3d& t = pose.world_from_body.translation();
    const Eigen::Quaterniond q(pose.world_from_body.rotation());
    text += fmt::format("{} {} {} {} {} {} {} {}\n", pose.time, t.x(), t.y(), t.z(), q.x(), q.y(),
                        q.z(), q.w());
  }
  AtomicWrite(path, text);
}

std::vector<SE3> ReadKittiPoses(const std::filesystem::path& path) {
  const TextTable table(path);
  std::vector<SE3> poses;
  poses.reserve(table.rows().size());
  for (const TextTable::Row& row : table.rows()) {
    table.RequireFields(row, 12, "a 3x4 matrix");
    const std::array<double, 12> values = table.Numbers<12>(row);
    const Eigen::Map<const RowMajor34> T(values.data());
    const Eigen::Matrix3d R = T.leftCols<3>();
    if (!IsRotation(R)) table.Fail(row, "the left 3x3 block is not a rotation");
    poses.emplace_back(IsRotation(R, 1e-12) ? R : NearestRotation(R), T.col(3));
  }
  Require(!poses.empty(), path.string(), "holds no pose");
  return poses;
}

void WriteKittiPoses(const std::filesystem::path& path, const std::vector<SE3>& poses) {
  std::string text;
  for (const SE3& pose : poses) {
    const RowMajor34 T = pose.Matrix().topRows<3>();
    text += fmt::format("{}\n", fmt::join(T.data(), T.data() + T.size(), " "));
  }
  AtomicWrite(path, text);
}

}  // namespace recollect
