#pragma once

#include <torch/torch.h>

#include <cstdint>
#include <vector>

namespace recollect::cnn {

// A convolution and the rectifier behind it.
struct ListedLayer {
  torch::Tensor weight, bias;  // [O, I, h, w], [O]; the network's own
  float slope = 1;             // of negative values; 1: no rectifier
  std::int64_t stride = 1, padding = 0;
};

// The layers of a sequence of convolutions and PReLUs of one slope; all others in it are taken for
// such that do nothing in answering (dropout).
std::vector<ListedLayer> LayersOf(const torch::nn::Sequential& sequence);

}  // namespace recollect::cnn
