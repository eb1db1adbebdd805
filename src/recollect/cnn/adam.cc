#include "recollect/cnn/adam.h"

#include <cmath>

namespace recollect::cnn {

Adam::Adam(torch::nn::Module& network, const AdamOptions& options) : options_(options) {
  for (const auto& item : network.named_parameters()) {
    slots_.push_back({item.key(), item.value(), torch::zeros_like(item.value()),
                      torch::zeros_like(item.value())});
  }
}

void Adam::Step(double learning_rate) {
  const torch::NoGradGuard no_gradients;
  ++step_;
  double scale = 1;
  if (options_.gradient_limit > 0) {
    double square = 0;
    for (const Slot& slot : slots_) {
      if (slot.parameter.grad().defined()) {
        square += slot.parameter.grad().square().sum().item<double>();
      }
    }
    scale = std::min(1.0, options_.gradient_limit / std::sqrt(square + 1e-20));
  }
  const double correction1 = 1 - std::pow(options_.beta1, step_);
  const double correction2 = 1 - std::pow(options_.beta2, step_);
  for (Slot& slot : slots_) {
    torch::Tensor& gradient = slot.parameter.mutable_grad();
    if (!gradient.defined()) continue;
    if (scale < 1) gradient.mul_(scale);
    slot.mean.mul_(options_.beta1).add_(gradient, 1 - options_.beta1);
    slot.square.mul_(options_.beta2).addcmul_(gradient, gradient, 1 - options_.beta2);
    if (options_.weight_decay > 0) slot.parameter.mul_(1 - learning_rate * options_.weight_decay);
    const torch::Tensor root = slot.square.sqrt().div_(std::sqrt(correction2));
    slot.parameter.addcdiv_(slot.mean, root.add_(options_.epsilon), -learning_rate / correction1);
    gradient.reset();
  }
}

std::vector<NamedTensor> Adam::State() const {
  std::vector<NamedTensor> state;
  for (const Slot& slot : slots_) {
    state.emplace_back("adam.mean." + slot.name, slot.mean);
    state.emplace_back("adam.square." + slot.name, slot.square);
  }
  return state;
}

void Adam::Restore(const TensorFile& file, std::int64_t step, const std::string& where) {
  const torch::NoGradGuard no_gradients;
  step_ = step;
  for (Slot& slot : slots_) {
    slot.mean.copy_(file.Find("adam.mean." + slot.name, slot.mean, where));
    slot.square.copy_(file.Find("adam.square." + slot.name, slot.square, where));
  }
}

}  // namespace recollect::cnn
