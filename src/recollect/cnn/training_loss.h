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
  torch::Tensor projection;      // the paper's, metres
  torch::Tensor correspondence;  // cross-entropy, nats
  torch::Tensor depth;           // mean |log predicted / true|
  torch::Tensor position_m;      // mean distance of predicted from true position; not in the total
};

// The losses of the options for pairs of one camera.
class TrainingLoss {
 public:
  TrainingLoss(const PinholeCamera& crop_camera, const LossOptions& options);
  Losses operator()(const Prediction& prediction, const Batch& batch) const;

 private:
  LossOptions options_;
  PinholeCamera cells_;  // the camera of the cell grid
  torch::Tensor rays_;   // [3, H / kDepthStep, W / kDepthStep]
};

}  // namespace recollect::cnn
