#pragma once

#include <gtest/gtest.h>
#include <torch/torch.h>

#include <functional>
#include <vector>

namespace recollect::cnn {

// Checks the gradients of `function` with respect to each of `inputs` (double precision) against
// central differences. The function's values are weighed with fixed random numbers and summed, so
// that each of them counts. A failure names the input and the element.
inline void ExpectGradients(
    const std::function<torch::Tensor(const std::vector<torch::Tensor>&)>& function,
    std::vector<torch::Tensor> inputs, double tolerance = 1e-6, double step = 1e-5) {
  torch::manual_seed(77);
  for (torch::Tensor& input : inputs) {
    ASSERT_EQ(input.scalar_type(), torch::kDouble);
    input = input.clone().requires_grad_(true);
  }
  const torch::Tensor values = function(inputs);
  const torch::Tensor weights = torch::randn_like(values);
  (values * weights).sum().backward();
  const auto scalar = [&] {
    const torch::NoGradGuard no_gradients;
    return (function(inputs) * weights).sum().item<double>();
  };
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    ASSERT_TRUE(inputs[i].grad().defined()) << "input " << i << " has no gradient";
    const torch::Tensor gradient = inputs[i].grad().contiguous();
    auto* element = inputs[i].data_ptr<double>();
    for (std::int64_t j = 0; j < inputs[i].numel(); ++j) {
      const double kept = element[j];
      element[j] = kept + step;
      const double above = scalar();
      element[j] = kept - step;
      const double below = scalar();
      element[j] = kept;
      const double numeric = (above - below) / (2 * step);
      const double analytic = gradient.data_ptr<double>()[j];
      EXPECT_NEAR(analytic, numeric, tolerance * std::max(1.0, std::abs(numeric)))
          << "input " << i << ", element " << j;
    }
  }
}

}  // namespace recollect::cnn
