#include "recollect/cnn/cell_solver.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "recollect/geometry/se3.h"

namespace recollect::cnn {
namespace {

constexpr float kNearest = 0.5F;  // metres; what would come closer than this is not used

}  // namespace

Eigen::Matrix<double, 3, 4> SolveCells(const float* points, const float* seen, const float* weight,
                                       std::int64_t count, const SolverOptions& options) {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  Vector6d prior;
  prior.head<3>().setConstant(options.sighting_sd / options.prior_rotation_sd);
  prior.tail<3>().setConstant(options.sighting_sd / options.prior_translation_sd);
  const auto inverse_outlier = static_cast<float>(1 / (options.outlier * options.outlier));
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    const Eigen::Matrix3f r = rotation.cast<float>();
    const Eigen::Vector3f t = translation.cast<float>();
    using Vector6f = Eigen::Matrix<float, 6, 1>;
    Eigen::Matrix<float, 6, 6> normal = Eigen::Matrix<float, 6, 6>::Zero();
    Vector6f right = Vector6f::Zero();
    for (std::int64_t i = 0; i < count; ++i) {
      if (weight[i] <= 0) continue;
      const Eigen::Vector3f p(points[i], points[count + i], points[2 * count + i]);
      const Eigen::Vector3f q = r * p, moved = q + t;
      if (moved.z() <= kNearest) continue;
      const float iz = 1 / moved.z(), x = moved.x() * iz, y = moved.y() * iz;
      const float dx = seen[i] - x, dy = seen[count + i] - y;
      const float w = weight[i] / (1 + (dx * dx + dy * dy) * inverse_outlier);
      // The rows of StepFrom in motion_solver.cc.
      Vector6f row_x, row_y;
      row_x << -x * q.y() * iz, (q.z() + x * q.x()) * iz, -q.y() * iz, iz, 0, -x * iz;
      row_y << -(q.z() + y * q.y()) * iz, y * q.x() * iz, q.x() * iz, 0, iz, -y * iz;
      normal.noalias() += w * row_x * row_x.transpose();
      normal.noalias() += w * row_y * row_y.transpose();
      right += w * (dx * row_x + dy * row_y);
    }
    Matrix6d system = normal.cast<double>();
    system.diagonal() += prior.cwiseAbs2();
    const Vector6d step = system.ldlt().solve(right.cast<double>());
    rotation = ExpSo3(step.head<3>()) * rotation;
    translation += step.tail<3>();
  }
  Eigen::Matrix<double, 3, 4> motion;
  motion << rotation, translation;
  return motion;
}

}  // namespace recollect::cnn
