#include "recollect/cnn/loss.h"

#include <cmath>

#include "recollect/cnn/layers.h"

namespace recollect::cnn {
namespace {

// Keeps the square root differentiable at zero.
constexpr double kSmallest = 1e-10;

constexpr double kNearest = 0.5;  // metres, of points that are projected

constexpr double kDegreesOfFreedom = 4;  // of the t distribution of errors

torch::Tensor Norm(const torch::Tensor& x) { return (x.square().sum(1) + kSmallest).sqrt(); }

}  // namespace

torch::Tensor WeightedMean(const torch::Tensor& values, const torch::Tensor& weight,
                           const Divisor& divisor) {
  const torch::Tensor weights = weight.sum();
  return (values * weight).sum() / (divisor ? divisor(weights) : weights).clamp_min(1.0);
}

torch::Tensor ProjectionLoss(const torch::Tensor& predicted, const torch::Tensor& truth,
                             const torch::Tensor& points, const torch::Tensor& valid,
                             double far_metres, const Divisor& divisor) {
  torch::Tensor bounded = points;
  if (far_metres > 0) {
    const torch::Tensor z = points.slice(1, 2, 3).clamp_min(1e-6);
    bounded = points * (far_metres / z).clamp_max(1.0);
  }
  // T_pred p - T_true p = (T_pred - T_true) p: one product instead of two.
  const torch::Tensor distance = Norm(Transform(predicted - truth, bounded));
  return WeightedMean(distance, valid.to(distance.scalar_type()), divisor);
}

torch::Tensor ReprojectionLoss(const torch::Tensor& predicted, const torch::Tensor& truth,
                               const torch::Tensor& points, const torch::Tensor& valid, double fx,
                               double fy, const Divisor& divisor) {
  const torch::Tensor focal = torch::tensor({fx, fy}, points.options()).view({1, 2, 1});
  const auto project = [&](const torch::Tensor& moved) {
    return moved.slice(1, 0, 2) / moved.slice(1, 2, 3).clamp_min(kNearest) * focal;
  };
  const torch::Tensor seen = Transform(truth, points);
  const torch::Tensor distance = Norm(project(Transform(predicted, points)) - project(seen));
  const torch::Tensor counts = valid.to(torch::kBool) & (seen.select(1, 2) > kNearest);
  return WeightedMean(distance, counts.to(distance.scalar_type()), divisor);
}

MotionDistance DistanceBetween(const torch::Tensor& predicted, const torch::Tensor& truth) {
  const torch::Tensor difference = predicted - truth;
  // |R - R'|_F = 2 sqrt(2) sin(angle / 2).
  const torch::Tensor turned = difference.slice(2, 0, 3).flatten(1) / std::sqrt(2.0);
  return {Norm(difference.select(2, 3)), Norm(turned)};
}

torch::Tensor WeightedPoseLoss(const torch::Tensor& predicted, const torch::Tensor& truth,
                               double beta) {
  const MotionDistance d = DistanceBetween(predicted, truth);
  return (d.translation + beta * d.rotation).mean();
}

torch::Tensor HomoscedasticLoss(const torch::Tensor& predicted, const torch::Tensor& truth,
                                const torch::Tensor& s) {
  const MotionDistance d = DistanceBetween(predicted, truth);
  return d.translation.mean() * (-s[0]).exp() + s[0] + d.rotation.mean() * (-s[1]).exp() + s[1];
}

torch::Tensor LikelihoodLoss(const torch::Tensor& predicted, const torch::Tensor& truth,
                             const torch::Tensor& whitening) {
  const torch::Tensor x = Se3Difference(predicted, truth).unsqueeze(2);
  const torch::Tensor square = torch::bmm(whitening, x).square().sum({1, 2});
  const torch::Tensor log_volume = whitening.diagonal(0, 1, 2).log().sum(1);
  constexpr double kExponent = (kDegreesOfFreedom + 6) / 2;
  return (kExponent * (square / kDegreesOfFreedom).log1p() - log_volume).mean();
}

}  // namespace recollect::cnn
