#pragma once

#include <torch/torch.h>

#include "recollect/cnn/motion_solver.h"

namespace recollect::cnn {

// How sure a motion is, from the features it was regressed from, from what least squares says
// (MotionPrecision) and how well its sightings agree (MotionFit): two linear layers give the 21
// numbers of a triangular factor of the inverse covariance. Nothing flows back into its inputs: the
// motion is learnt as if it were not there.
class CovarianceHead : public torch::nn::Module {
 public:
  // features: numbers a pair.
  explicit CovarianceHead(std::int64_t features);

  // features [B, features]; `solved` [B, 3, 4], the solution of `sightings`, and its `agreement`
  // [B, 3] with them. The result is Prediction::whitening, of errors of 0.01 rad and 0.3 m before
  // any training.
  torch::Tensor forward(const torch::Tensor& features, const torch::Tensor& solved,
                        const Sightings& sightings, const torch::Tensor& agreement);

 private:
  torch::nn::Sequential layers_;
  torch::Tensor units_;  // [6]: rad and m that count as one
  torch::Tensor above_;  // [15]: where the numbers above the diagonal stand in a row of 36
};

}  // namespace recollect::cnn
