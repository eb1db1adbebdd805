#pragma once

#include <torch/torch.h>

#include "recollect/cnn/cell_solver.h"

// The motion that best explains where points of the live image are seen in the key frame: weighted
// least squares over all cells at once, as a layer. B is the batch, N the number of cells.
namespace recollect::cnn {

struct Sightings {
  torch::Tensor points;  // [B, 3, N]: in the live camera's frame, metres
  torch::Tensor seen;    // [B, 2, N]: (x, y) = (X, Y) / Z where the key frame sees them
  torch::Tensor weight;  // [B, N]: 0 or more
};

// One Gauss-Newton step from motion [B, 3, 4]: (dw, dt) [B, 6] with R <- Exp(dw) R, t <- t + dt.
// Differentiable in all of `sightings`.
torch::Tensor SolverStep(const torch::Tensor& motion, const Sightings& sightings,
                         const SolverOptions& options);

// keyframe_from_live [B, 3, 4], by steps from "no motion" whose weights fall with the residuals
// (Cauchy). Gradients are those of the last step, which at the minimum are the minimum's own.
torch::Tensor SolveMotion(const Sightings& sightings, const SolverOptions& options = {});

// What the sightings, each taken for the only witness of its place, say about how sure `motion` is:
// the inverse covariance [B, 6, 6] of x in true motion = motion * Exp(x), rotation first, rad and
// m.
torch::Tensor MotionPrecision(const torch::Tensor& motion, const Sightings& sightings,
                              const SolverOptions& options = {});

// How well `motion` and the sightings agree, [B, 3], as logarithms: the mean weight; the share of
// it that is left where weights fall with the residuals; the mean square of the residuals under
// what is left, in `sighting_sd`. Fog and other days show here.
torch::Tensor MotionFit(const torch::Tensor& motion, const Sightings& sightings,
                        const SolverOptions& options = {});

// SE3 layer of delta [B, 6] applied as in SolverStep.
torch::Tensor Moved(const torch::Tensor& motion, const torch::Tensor& delta);

}  // namespace recollect::cnn
