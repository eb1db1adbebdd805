#pragma once

#include <torch/torch.h>

#include <cstdint>
#include <string>
#include <vector>

#include "recollect/cnn/elementwise.h"
#include "recollect/cnn/tensor_file.h"

namespace recollect::cnn {

struct AdamOptions {
  double beta1 = 0.9, beta2 = 0.999, epsilon = 1e-8;
  double weight_decay = 0;  // decoupled (AdamW), times the learning rate
  double gradient_limit =
      0;  // gradients longer than this, over all parameters, are scaled; 0: none
  // Parameters whose names begin with this are bounded by themselves: what trains beside the others
  // is not to change their steps. Empty: no such parameters.
  std::string apart = {};
};

// Adam (Kingma and Ba 2015), AdamW with weight decay. Unlike torch's its whole state can be put in
// a file and taken back from there, bit for bit.
class Adam {
 public:
  Adam(torch::nn::Module& network, const AdamOptions& options);

  // One step down the parameters' gradients, which are then cleared. False where a gradient is not
  // finite: nothing has changed then but that they are cleared.
  bool Step(double learning_rate);

  // The moments, named after the parameters; and back, for the step number they were taken at.
  std::vector<NamedTensor> State() const;
  void Restore(const TensorFile& file, std::int64_t step, const std::string& where);

 private:
  struct Slot {
    std::string name;
    torch::Tensor parameter, mean, square;
    std::size_t group;  // 0, or 1 for those apart
  };
  // Of the step that is being made, for parameters whose gradient has that squared length.
  AdamRates Rates(double learning_rate, double gradient_square) const;
  static void StepInOnePass(Slot& slot, const torch::Tensor& gradient, const AdamRates& rates);
  static void StepByTensors(Slot& slot, const torch::Tensor& gradient, const AdamRates& rates);

  AdamOptions options_;
  std::vector<Slot> slots_;
  std::int64_t step_ = 0;
};

}  // namespace recollect::cnn
