#include "recollect/cnn/loss.h"

#include "recollect/cnn/layers.h"

namespace recollect::cnn {
namespace {

// Keeps the square root differentiable at zero.
constexpr double kSmallest = 1e-10;

torch::Tensor Norm(const torch::Tensor& x) { return (x.square().sum(1) + kSmallest).sqrt(); }

}  // namespace

torch::Tensor ProjectionLoss(const torch::Tensor& predicted, const torch::Tensor& truth,
                             const torch::Tensor& points, const torch::Tensor& valid,
                             double far_metres) {
  torch::Tensor bounded = points;
  if (far_metres > 0) {
    const torch::Tensor z = points.slice(1, 2, 3).clamp_min(1e-6);
    bounded = points * (far_metres / z).clamp_max(1.0);
  }
  // T_pred p - T_true p = (T_pred - T_true) p: one product instead of two.
  const torch::Tensor distance = Norm(Transform(predicted - truth, bounded));
  const torch::Tensor weight = valid.to(distance.scalar_type());
  return (distance * weight).sum() / weight.sum().clamp_min(1.0);
}

torch::Tensor WeightedPoseLoss(const torch::Tensor& predicted, const torch::Tensor& truth,
                               double beta) {
  const torch::Tensor difference = predicted - truth;
  return (Norm(difference.slice(1, 3, 6)) + beta * Norm(difference.slice(1, 0, 3))).mean();
}

}  // namespace recollect::cnn
