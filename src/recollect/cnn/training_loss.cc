#include "recollect/cnn/training_loss.h"

#include "recollect/cnn/compact_network.h"
#include "recollect/cnn/layers.h"
#include "recollect/cnn/loss.h"

namespace recollect::cnn {
namespace {

constexpr int kStride = kCellPixels / kDepthStep;  // from the depth grid to the cell grid

torch::Tensor EveryCell(const torch::Tensor& depth) {
  return depth.slice(1, 0, torch::nullopt, kStride).slice(2, 0, torch::nullopt, kStride);
}

torch::Tensor DepthLoss(const torch::Tensor& log_depth, const torch::Tensor& depth,
                        const torch::Tensor& valid) {
  const torch::Tensor weight = valid.to(depth.scalar_type());
  const torch::Tensor error = (log_depth - depth.clamp_min(0.1).log()).abs() * weight;
  return error.sum() / weight.sum().clamp_min(1.0);
}

}  // namespace

TrainingLoss::TrainingLoss(const PinholeCamera& crop_camera, const LossOptions& options)
    : options_(options),
      cells_(crop_camera.Subsampled(kCellPixels)),
      rays_(RayGrid(crop_camera.Subsampled(kDepthStep))) {}

Losses TrainingLoss::operator()(const Prediction& prediction, const Batch& batch) const {
  Losses losses;
  const torch::Tensor points = Grid3d(batch.depth, rays_);
  losses.projection = ProjectionLoss(prediction.motion, batch.motion, points,
                                     batch.depth.flatten(1) > 0, options_.far_metres);
  losses.total = losses.projection;
  losses.position_m = (prediction.motion - batch.motion).detach().select(2, 3).norm(2, 1).mean();
  if (!prediction.total.defined()) return losses;

  const torch::Tensor cell_depth = EveryCell(batch.depth).flatten(1);
  const torch::Tensor valid = cell_depth > 0;
  if (options_.correspondence_weight > 0) {
    const Grid grid{cells_.height, cells_.width};
    const torch::Tensor cell_points = Grid3d(EveryCell(batch.depth), EveryCell(rays_));
    const TrueFlow truth = ProjectCells(cell_points, valid, batch.motion, grid, cells_.fx,
                                        cells_.fy, cells_.cx, cells_.cy);
    losses.correspondence = CorrespondenceLoss(prediction.live_features, prediction.key_features,
                                               prediction.total, truth, grid);
    losses.total = losses.total + options_.correspondence_weight * losses.correspondence;
  }
  if (options_.depth_weight > 0) {
    losses.depth = DepthLoss(prediction.log_depth, cell_depth, valid);
    losses.total = losses.total + options_.depth_weight * losses.depth;
  }
  return losses;
}

}  // namespace recollect::cnn
