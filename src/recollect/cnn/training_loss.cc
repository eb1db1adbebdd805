#include "recollect/cnn/training_loss.h"

#include <utility>
#include <vector>

#include "recollect/cnn/compact_network.h"
#include "recollect/cnn/layers.h"
#include "recollect/cnn/loss.h"

namespace recollect::cnn {
namespace {

// Where learnt weights begin: metres count as they are, radians e^3 times.
const std::vector<float> kFirstLogWeights = {0, -3};
constexpr int kStride = kCellPixels / kDepthStep;  // from the depth grid to the cell grid

torch::Tensor EveryCell(const torch::Tensor& depth) {
  return depth.slice(1, 0, torch::nullopt, kStride).slice(2, 0, torch::nullopt, kStride);
}

torch::Tensor DepthLoss(const torch::Tensor& log_depth, const torch::Tensor& depth,
                        const torch::Tensor& valid, const Divisor& divisor) {
  const torch::Tensor error = (log_depth - depth.clamp_min(0.1).log()).abs();
  return WeightedMean(error, valid.to(depth.scalar_type()), divisor);
}

}  // namespace

TrainingLoss::TrainingLoss(const PinholeCamera& crop_camera, const LossOptions& options,
                           Divisor divisor)
    : options_(options),
      divisor_(std::move(divisor)),
      crop_(crop_camera),
      cells_(crop_camera.Subsampled(kCellPixels)),
      rays_(register_buffer("rays", RayGrid(crop_camera.Subsampled(kDepthStep)))) {
  if (options.kind == LossKind::kHomoscedastic) {
    log_weights_ = register_parameter("log_weights", torch::tensor(kFirstLogWeights));
  }
}

torch::Tensor TrainingLoss::PoseLoss(const torch::Tensor& motion, const Batch& batch,
                                     const torch::Tensor& points) const {
  const torch::Tensor valid = batch.depth.flatten(1) > 0;
  switch (options_.kind) {
    case LossKind::kReprojection:
      return ReprojectionLoss(motion, batch.motion, points, valid, crop_.fx, crop_.fy, divisor_);
    case LossKind::kL2:
      return WeightedPoseLoss(motion, batch.motion, options_.beta);
    case LossKind::kHomoscedastic:
      return HomoscedasticLoss(motion, batch.motion, log_weights_);
    case LossKind::kProjection:
    case LossKind::kUncertainty:
      break;
  }
  return ProjectionLoss(motion, batch.motion, points, valid, options_.far_metres, divisor_);
}

Losses TrainingLoss::operator()(const Prediction& prediction, const Batch& batch) const {
  Losses losses;
  const torch::Tensor points = Grid3d(batch.depth, rays_);
  losses.total = PoseLoss(prediction.motion, batch, points);
  losses.projection = losses.total;
  if (options_.kind != LossKind::kProjection && options_.kind != LossKind::kUncertainty) {
    // For the curve.
    losses.projection = ProjectionLoss(prediction.motion.detach(), batch.motion, points,
                                       batch.depth.flatten(1) > 0, options_.far_metres, divisor_);
  }
  losses.position_m = (prediction.motion - batch.motion).detach().select(2, 3).norm(2, 1).mean();
  if (options_.kind == LossKind::kUncertainty) {
    losses.likelihood =
        LikelihoodLoss(prediction.motion.detach(), batch.motion, prediction.whitening);
    losses.total = losses.total + losses.likelihood;  // whose weights nothing else has
  }
  if (!prediction.total.defined()) return losses;

  const torch::Tensor cell_depth = EveryCell(batch.depth).flatten(1);
  const torch::Tensor valid = cell_depth > 0;
  if (options_.correspondence_weight > 0) {
    const Grid grid{cells_.height, cells_.width};
    const torch::Tensor cell_points = Grid3d(EveryCell(batch.depth), EveryCell(rays_));
    const TrueFlow truth = ProjectCells(cell_points, valid, batch.motion, grid, cells_.fx,
                                        cells_.fy, cells_.cx, cells_.cy);
    losses.correspondence = CorrespondenceLoss(prediction.live_features, prediction.key_features,
                                               prediction.total, truth, grid, divisor_);
    losses.total = losses.total + options_.correspondence_weight * losses.correspondence;
  }
  if (options_.depth_weight > 0) {
    losses.depth = DepthLoss(prediction.log_depth, cell_depth, valid, divisor_);
    losses.total = losses.total + options_.depth_weight * losses.depth;
  }
  return losses;
}

}  // namespace recollect::cnn
