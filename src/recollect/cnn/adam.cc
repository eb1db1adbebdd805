#include "recollect/cnn/adam.h"

#include <ATen/Parallel.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <numeric>

namespace recollect::cnn {
namespace {

constexpr std::int64_t kGrain = 1 << 16;

// Whether the tensors can be walked through side by side, as they lie in memory.
bool LieAlike(std::initializer_list<torch::Tensor> tensors) {
  const torch::Tensor& first = *tensors.begin();
  return std::all_of(tensors.begin(), tensors.end(), [&](const torch::Tensor& t) {
    return t.is_cpu() && t.scalar_type() == torch::kFloat && t.strides() == first.strides() &&
           t.is_non_overlapping_and_dense();
  });
}

// In parts, whose number does not depend on that of the threads.
double SumOfSquares(const torch::Tensor& gradient) {
  if (!LieAlike({gradient})) return gradient.square().sum(torch::kDouble).item<double>();
  std::vector<double> sums(static_cast<std::size_t>((gradient.numel() + kGrain - 1) / kGrain));
  const auto* values = gradient.data_ptr<float>();
  at::parallel_for(0, static_cast<std::int64_t>(sums.size()), 1,
                   [&](std::int64_t begin, std::int64_t end) {
                     for (std::int64_t i = begin; i < end; ++i) {
                       const std::int64_t from = i * kGrain;
                       sums[static_cast<std::size_t>(i)] =
                           SquareSum(values + from, std::min(kGrain, gradient.numel() - from));
                     }
                   });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

}  // namespace

Adam::Adam(torch::nn::Module& network, const AdamOptions& options) : options_(options) {
  for (const auto& item : network.named_parameters()) {
    const bool apart = !options.apart.empty() && item.key().starts_with(options.apart);
    slots_.push_back({item.key(), item.value(), torch::zeros_like(item.value()),
                      torch::zeros_like(item.value()), apart ? 1U : 0U});
  }
}

AdamRates Adam::Rates(double learning_rate, double gradient_square) const {
  double scale = 1;
  if (options_.gradient_limit > 0) {
    scale = std::min(1.0, options_.gradient_limit / std::sqrt(gradient_square + 1e-20));
  }
  const double correction1 = 1 - std::pow(options_.beta1, step_);
  const double correction2 = 1 - std::pow(options_.beta2, step_);
  return {.beta1 = static_cast<float>(options_.beta1),
          .beta2 = static_cast<float>(options_.beta2),
          .epsilon = static_cast<float>(options_.epsilon),
          .gradient_scale = static_cast<float>(scale),
          .keep = static_cast<float>(1 - learning_rate * options_.weight_decay),
          .step = static_cast<float>(learning_rate / correction1),
          .root_scale = static_cast<float>(1 / std::sqrt(correction2))};
}

bool Adam::Step(double learning_rate) {
  const torch::NoGradGuard no_gradients;
  std::array<double, 2> squares{};
  for (const Slot& slot : slots_) {
    const torch::Tensor& gradient = slot.parameter.grad();
    if (gradient.defined()) squares[slot.group] += SumOfSquares(gradient);
  }
  if (!std::isfinite(squares[0] + squares[1])) {
    for (Slot& slot : slots_) slot.parameter.mutable_grad().reset();
    return false;
  }
  ++step_;
  std::array<AdamRates, 2> rates;
  for (std::size_t group = 0; group < rates.size(); ++group) {
    rates[group] = Rates(learning_rate, squares[group]);
  }
  for (Slot& slot : slots_) {
    torch::Tensor& gradient = slot.parameter.mutable_grad();
    if (!gradient.defined()) continue;
    if (LieAlike({slot.parameter, slot.mean, slot.square, gradient})) {
      StepInOnePass(slot, gradient, rates[slot.group]);
    } else {
      StepByTensors(slot, gradient, rates[slot.group]);
    }
    gradient.reset();
  }
  return true;
}

void Adam::StepInOnePass(Slot& slot, const torch::Tensor& gradient, const AdamRates& rates) {
  auto* parameter = slot.parameter.data_ptr<float>();
  auto *mean = slot.mean.data_ptr<float>(), *square = slot.square.data_ptr<float>();
  const auto* values = gradient.data_ptr<float>();
  at::parallel_for(0, gradient.numel(), kGrain, [&](std::int64_t begin, std::int64_t end) {
    AdamStep(parameter + begin, mean + begin, square + begin, values + begin, end - begin, rates);
  });
}

void Adam::StepByTensors(Slot& slot, const torch::Tensor& gradient, const AdamRates& r) {
  const torch::Tensor g = gradient * r.gradient_scale;
  slot.mean.mul_(r.beta1).add_(g, 1 - r.beta1);
  slot.square.mul_(r.beta2).addcmul_(g, g, 1 - r.beta2);
  const torch::Tensor root = slot.square.sqrt().mul_(r.root_scale).add_(r.epsilon);
  slot.parameter.mul_(r.keep).addcdiv_(slot.mean, root, -r.step);
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
