#include "recollect/cnn/covariance_calibration.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "recollect/core/error.h"

namespace recollect::cnn {
namespace {

constexpr double kFurthest = 3;  // of the logarithm of a factor from that of usual agreement
constexpr double kFreedom = 4, kDimensions = 6;
constexpr double kPull = 10;  // pairs' worth of weights that are none
constexpr int kSteps = 30;
constexpr double kSmall = 1e-9;

using Coefficients = Eigen::Vector4d;  // a constant first

// Newton's method on the negative logarithm of the likelihood of squares whose scale is
// exp(row * coefficients), which is convex.
Coefficients Likeliest(std::span<const double> squares, const Eigen::MatrixX4d& rows) {
  Coefficients now = Coefficients::Zero();
  const auto loss = [&](const Coefficients& at) {
    double sum = kPull / 2 * at.tail<3>().squaredNorm();
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
      const double log_scale = rows.row(i).dot(at);
      sum += kDimensions / 2 * log_scale +
             (kFreedom + kDimensions) / 2 *
                 std::log1p(squares[static_cast<std::size_t>(i)] * std::exp(-log_scale) / kFreedom);
    }
    return sum;
  };
  for (int step = 0; step < kSteps; ++step) {
    Coefficients gradient = kPull * now;
    Eigen::Matrix4d curvature = kPull * Eigen::Matrix4d::Identity();
    gradient[0] = 0;
    curvature(0, 0) = kSmall;
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
      const double ratio =
          squares[static_cast<std::size_t>(i)] * std::exp(-rows.row(i).dot(now)) / kFreedom;
      const double pull = (kFreedom + kDimensions) / 2 / (1 + ratio);
      gradient += (kDimensions / 2 - pull * ratio) * rows.row(i).transpose();
      curvature += pull * ratio / (1 + ratio) * rows.row(i).transpose() * rows.row(i);
    }
    Coefficients move = -curvature.ldlt().solve(gradient);
    const double before = loss(now);
    while (loss(now + move) > before && move.norm() > kSmall) move /= 2;
    now += move;
    if (move.norm() < kSmall) break;
  }
  return now;
}

// The least value that so large a share of them, and no less, do not exceed.
double Quantile(std::vector<double> values, double share) {
  const auto count = static_cast<double>(values.size());
  const auto at = static_cast<std::ptrdiff_t>(std::ceil(share * count - 1e-9)) - 1;
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

}  // namespace

double CovarianceCalibration::FactorOf(const Eigen::Vector3d& agreement) const {
  return scale * std::exp(std::clamp(weights.dot(agreement - usual), -kFurthest, kFurthest));
}

CovarianceCalibration Calibrate(std::span<const double> squares,
                                std::span<const Eigen::Vector3d> agreements, double share,
                                double bound) {
  Require(squares.size() == agreements.size(), "covariance calibration",
          "needs an agreement for every error");
  CovarianceCalibration found;
  if (squares.empty()) return found;
  const auto count = static_cast<Eigen::Index>(squares.size());
  Eigen::MatrixX4d rows(count, 4);
  rows.col(0).setOnes();
  for (Eigen::Index i = 0; i < count; ++i) {
    rows.row(i).tail<3>() = agreements[static_cast<std::size_t>(i)].transpose();
  }
  found.usual = rows.rightCols<3>().colwise().mean().transpose();
  rows.rightCols<3>().rowwise() -= found.usual.transpose();
  const Eigen::Vector3d spread =
      (rows.rightCols<3>().colwise().squaredNorm().transpose() / static_cast<double>(count))
          .cwiseSqrt()
          .cwiseMax(kSmall);
  rows.rightCols<3>().array().rowwise() /= spread.transpose().array();
  found.weights = Likeliest(squares, rows).tail<3>().cwiseQuotient(spread);

  std::vector<double> scaled;
  for (std::size_t i = 0; i < squares.size(); ++i) {
    scaled.push_back(squares[i] / found.FactorOf(agreements[i]));
  }
  // A little more than needed: rounding is not to put the last one outside.
  found.scale = std::max(Quantile(std::move(scaled), share) / bound, 1e-12) * (1 + 1e-9);
  return found;
}

}  // namespace recollect::cnn
