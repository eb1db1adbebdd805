#pragma once

#include <torch/torch.h>

#include <cstdint>
#include <vector>

#include "recollect/core/huge_pages.h"

namespace recollect::cnn {

// A product with weights of 16 bits: whole numbers, and one float a row of them that they count as.
// Where few rows meet many weights, reading these is what the time goes into, and half as many
// bytes take half of it; they lie as they are read, in huge pages, and are fetched ahead, so that
// memory is the limit. A weight is off by at most 1.5e-5 of its row's greatest; all else is done in
// 32-bit floats.
class FixedProduct {
 public:
  // weight [O, K] of floats, bias [O]; what follows is x, or slope * x for negative x.
  FixedProduct(const torch::Tensor& weight, const torch::Tensor& bias, float slope);

  // rows [R, K] of 32-bit floats -> [R, O].
  torch::Tensor Run(const torch::Tensor& rows) const;

 private:
  std::int64_t outputs_, inputs_;
  float slope_;
  // Some rows at a time, of these a vector each, one after the other; filled up with zeros.
  PageVector<std::int16_t> weights_;
  std::vector<float> scales_, bias_;
};

}  // namespace recollect::cnn
