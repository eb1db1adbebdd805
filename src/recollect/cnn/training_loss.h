#pragma once

#include <torch/torch.h>

#include "recollect/cnn/correspondence.h"
#include "recollect/cnn/loader.h"
#include "recollect/cnn/pair_network.h"
#include "recollect/cnn/train_options.h"

namespace recollect::cnn {

// What a step is judged by. Undefined where a part is switched off or the network has no such
// output.
struct Losses {
  torch::Tensor total;
  torch::Tensor projection;      // the paper's, metres; in the total where it is the chosen one
  torch::Tensor correspondence;  // cross-entropy, nats
  torch::Tensor depth;           // mean |log predicted / true|
  torch::Tensor likelihood;      // LikelihoodLoss of the predicted covariance
  torch::Tensor position_m;      // mean distance of predicted from true position; not in the total
};

// The losses of the options for pairs of one camera. Its parameters, if any, are trained along
// with the network.
class TrainingLoss : public torch::nn::Module {
 public:
  // divisor: see loss.h.
  TrainingLoss(const PinholeCamera& crop_camera, const LossOptions& options, Divisor divisor = {});
  Losses operator()(const Prediction& prediction, const Batch& batch) const;

 private:
  torch::Tensor PoseLoss(const torch::Tensor& motion, const Batch& batch,
                         const torch::Tensor& points) const;

  LossOptions options_;
  Divisor divisor_;
  PinholeCamera crop_, cells_;  // the camera of the crop, and of the cell grid
  torch::Tensor rays_;          // [3, H / kDepthStep, W / kDepthStep]
  torch::Tensor log_weights_;   // [2], of kHomoscedastic
};

}  // namespace recollect::cnn
