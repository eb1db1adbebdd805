#pragma once

#include <torch/torch.h>

#include <memory>
#include <string>

#include "recollect/cnn/network_kind.h"
#include "recollect/cnn/pair_engine.h"
#include "recollect/cnn/precision.h"
#include "recollect/core/error.h"

namespace recollect::cnn {

// What a network says of a batch of pairs.
struct Prediction {
  torch::Tensor motion;  // [B, 3, 4]: keyframe_from_live, metres
  // Of a network that correlates the two images: the features [B, C, cells] whose products are the
  // scores, and the logarithm of the scores' sum (Correlation::total), [B, cells]. Cells in row
  // order, cell (x, y) at pixel (8 x, 8 y). Undefined for other networks.
  torch::Tensor live_features, key_features, total;
  // Logarithm of the depth in metres of every live cell, [B, cells]; undefined where the network
  // has no such output.
  torch::Tensor log_depth;
  // How sure the motion is, [B, 6, 6], upper triangular with a positive diagonal: with
  // truth = motion * Exp(x), rotation first, rad and m, whitening * x is N(0, I) but for what
  // calibration finds (ModelInfo::covariance), and how well the pair's sightings agree, [B, 3]
  // (MotionFit). Undefined where the network has no such output.
  torch::Tensor whitening, agreement;
};

// A siamese network. Inputs [B, 3, H, W], RGB; see NetworkTraits for their scale.
class PairNetwork : public torch::nn::Module {
 public:
  virtual Prediction forward(const torch::Tensor& live, const torch::Tensor& key) = 0;

  // How activations are kept while training, and multiplied in convolutions; weights, their
  // gradients and the wide layers stay float. Throws Error where the network has one way only.
  virtual void TrainIn(Precision precision) {
    Require(precision == Precision::kFloat32, "bfloat16", "is for training the paper's networks");
  }

  // A faster way to the same answers, from the weights as they are now, for images of that size;
  // null where the network has none.
  virtual std::unique_ptr<PairEngine> MakeEngine(std::int64_t rows, std::int64_t columns,
                                                 Precision precision) {
    (void)rows, (void)columns, (void)precision;
    return nullptr;
  }
};

// A network with fresh weights, drawn from torch's global generator (torch::manual_seed), for
// crops taken by `camera`. covariance: with Prediction::whitening; its weights are drawn last, so
// that the others are the same. Throws Error where only the compact network has it.
std::shared_ptr<PairNetwork> MakeNetwork(NetworkKind kind, const PinholeCamera& camera,
                                         bool covariance = false);

// What the names of the covariance's weights begin with.
inline constexpr const char* kCovarianceWeights = "covariance.";

}  // namespace recollect::cnn
