#pragma once

#include <torch/torch.h>

#include <cstdint>
#include <vector>

#include "recollect/cnn/packed_layers.h"

namespace recollect::cnn {

// A product with weights of 16 bits: whole numbers, and one float a row of them that they count as.
// Where few rows meet many weights, reading these is what the time goes into, and half as many
// bytes take half of it. A weight is off by at most 1.5e-5 of its row's greatest; all else is done
// in 32-bit floats.
class FixedProduct {
 public:
  // weight [O, K] of floats, bias [O]; what follows is x, or slope * x for negative x.
  FixedProduct(const torch::Tensor& weight, const torch::Tensor& bias, float slope);

  // source [R, K] of 32-bit floats in row order; the result [R, O], too, lives until the next call.
  const dnnl::memory& Run(const dnnl::memory& source);

 private:
  std::int64_t outputs_, inputs_;
  float slope_;
  std::vector<std::int16_t> weights_;  // rows of inputs_, filled up with zeros to whole vectors
  std::vector<float> scales_, bias_;
  dnnl::memory result_;
};

}  // namespace recollect::cnn
