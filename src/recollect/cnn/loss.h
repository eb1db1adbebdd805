#pragma once

#include <torch/torch.h>

namespace recollect::cnn {

// The paper's loss (section III-D): mean over the valid pixels of |T_pred p - T_true p|, in
// metres; |x| = sqrt(x^2 + 1e-10). Motions [B, 3, 4], points [B, 3, N] of the live image in metres
// (Grid3d), valid [B, N] true where the depth is known. Zero where nothing is valid.
//
// far_metres > 0 pulls points further than that along z back to it, along their ray: a rotation
// moves far points most, and without a bound the sky line alone would drown the translation. The
// paper has no such bound (0).
torch::Tensor ProjectionLoss(const torch::Tensor& predicted, const torch::Tensor& truth,
                             const torch::Tensor& points, const torch::Tensor& valid,
                             double far_metres = 0);

// PoseNet's rival loss: mean of |t_pred - t| + beta |w_pred - w|; deltas [B, 6] as in Se3Layer.
torch::Tensor WeightedPoseLoss(const torch::Tensor& predicted, const torch::Tensor& truth,
                               double beta);

}  // namespace recollect::cnn
