#pragma once

#include <torch/torch.h>

#include <functional>

namespace recollect::cnn {

// What a sum over weighted values is divided by, from the sum of the weights [] to the same: with
// several processes the mean over them, so that the mean of their losses is that of all values.
using Divisor = std::function<torch::Tensor(const torch::Tensor& weights)>;

// Sum of values * weight over the sum of the weights, at least 1.
torch::Tensor WeightedMean(const torch::Tensor& values, const torch::Tensor& weight,
                           const Divisor& divisor = {});

// The paper's loss (section III-D): mean over the valid pixels of |T_pred p - T_true p|, in
// metres; |x| = sqrt(x^2 + 1e-10). Motions [B, 3, 4], points [B, 3, N] of the live image in metres
// (Grid3d), valid [B, N] true where the depth is known. Zero where nothing is valid.
//
// far_metres > 0 pulls points further than that along z back to it, along their ray: a rotation
// moves far points most, and without a bound the sky line alone would drown the translation. The
// paper has no such bound (0).
torch::Tensor ProjectionLoss(const torch::Tensor& predicted, const torch::Tensor& truth,
                             const torch::Tensor& points, const torch::Tensor& valid,
                             double far_metres = 0, const Divisor& divisor = {});

// Mean over the valid pixels of the distance between their projections under both motions, in
// pixels of the key frame (Kendall and Cipolla 2017). fx, fy in pixels. Points that come nearer
// than half a metre are left out, and predicted no nearer.
torch::Tensor ReprojectionLoss(const torch::Tensor& predicted, const torch::Tensor& truth,
                               const torch::Tensor& points, const torch::Tensor& valid, double fx,
                               double fy, const Divisor& divisor = {});

// How far two motions [B, 3, 4] are apart: |t - t'| in metres and 2 sin(angle / 2), for small
// angles that in radians; [B] each.
struct MotionDistance {
  torch::Tensor translation, rotation;
};
MotionDistance DistanceBetween(const torch::Tensor& predicted, const torch::Tensor& truth);

// PoseNet's rival loss (Kendall, Grimes and Cipolla 2015): mean translation + beta rotation.
torch::Tensor WeightedPoseLoss(const torch::Tensor& predicted, const torch::Tensor& truth,
                               double beta);

// The same with weights that are learnt (Kendall and Cipolla 2017): mean of
// translation exp(-s_0) + s_0 + rotation exp(-s_1) + s_1, s [2].
torch::Tensor HomoscedasticLoss(const torch::Tensor& predicted, const torch::Tensor& truth,
                                const torch::Tensor& s);

// Mean negative logarithm of the likelihood of x = Se3Difference(predicted, truth), but for a
// constant, under a t distribution of 4 degrees of freedom: as z = whitening * x ~ N(0, I) near the
// middle, but with tails that a pair gone wrong does not tear at. whitening [B, 6, 6], upper
// triangular with a positive diagonal.
torch::Tensor LikelihoodLoss(const torch::Tensor& predicted, const torch::Tensor& truth,
                             const torch::Tensor& whitening);

}  // namespace recollect::cnn
