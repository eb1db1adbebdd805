#include "recollect/geometry/alignment.h"

#include <Eigen/LU>
#include <Eigen/SVD>

#include "recollect/core/error.h"

namespace recollect {
namespace {

std::vector<Eigen::Vector3d> Positions(const std::vector<SE3>& poses) {
  std::vector<Eigen::Vector3d> positions;
  positions.reserve(poses.size());
  for (const SE3& pose : poses) positions.push_back(pose.translation());
  return positions;
}

}  // namespace

Similarity AlignPoints(const std::vector<Eigen::Vector3d>& source,
                       const std::vector<Eigen::Vector3d>& target, bool with_scale) {
  Require(source.size() == target.size(), "alignment",
          fmt::format("{} points against {}", source.size(), target.size()));
  Require(source.size() >= 3, "alignment", "fewer than three points leave the rotation open");
  const auto n = static_cast<Eigen::Index>(source.size());
  const Eigen::Map<const Eigen::Matrix3Xd> x(source.front().data(), 3, n);
  const Eigen::Map<const Eigen::Matrix3Xd> y(target.front().data(), 3, n);
  const Eigen::Vector3d mean_x = x.rowwise().mean(), mean_y = y.rowwise().mean();  // eq. 34, 35
  const Eigen::Matrix3Xd dx = x.colwise() - mean_x, dy = y.colwise() - mean_y;
  const double variance = dx.squaredNorm() / static_cast<double>(n);                // eq. 36
  const Eigen::Matrix3d covariance = dy * dx.transpose() / static_cast<double>(n);  // eq. 38

  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d d = svd.singularValues();
  Require(d.allFinite() && d[1] > 1e-12 * d[0] && d[0] > 0, "alignment",
          "points in one line leave the rotation open");
  const Eigen::Matrix3d U = svd.matrixU(), V = svd.matrixV();
  Eigen::Vector3d s = Eigen::Vector3d::Ones();  // eq. 43
  if (U.determinant() * V.determinant() < 0) s[2] = -1;
  const Eigen::Matrix3d R = U * s.asDiagonal() * V.transpose();  // eq. 40
  const double scale = with_scale ? d.dot(s) / variance : 1;     // eq. 42
  return {scale, SE3(R, mean_y - scale * (R * mean_x))};         // eq. 41
}

Similarity AlignPoses(const std::vector<SE3>& source, const std::vector<SE3>& target,
                      bool with_scale) {
  return AlignPoints(Positions(source), Positions(target), with_scale);
}

}  // namespace recollect
