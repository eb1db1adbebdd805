#include "recollect/cnn/fixed_product.h"

#include <ATen/Parallel.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "recollect/cnn/processors.h"

namespace recollect::cnn {
namespace {

constexpr std::int64_t kLanes = 16;
constexpr std::int64_t kOutputs = 4, kRows = 4;  // whose sums are in registers together
constexpr float kGreatest = 32767;

using Shorts = std::int16_t __attribute__((vector_size(kLanes * sizeof(std::int16_t))));
using Floats = float __attribute__((vector_size(kLanes * sizeof(float))));

std::int64_t Padded(std::int64_t inputs) { return (inputs + kLanes - 1) / kLanes * kLanes; }

// sums[r][o] = source row r . weight row o, both `stride` numbers long. Outputs beyond those there
// are repeat the last.
template <std::int64_t rows>
[[gnu::always_inline]] inline void TileOf(const float* source, const std::int16_t* weights,
                                          std::int64_t outputs, std::int64_t stride, float* sums) {
  const std::int16_t* by[kOutputs];
  for (std::int64_t o = 0; o < kOutputs; ++o) by[o] = weights + std::min(o, outputs - 1) * stride;
  Floats total[rows][kOutputs] = {};
  for (std::int64_t k = 0; k < stride; k += kLanes) {
    Floats values[rows];
    for (std::int64_t r = 0; r < rows; ++r) {
      std::memcpy(&values[r], source + r * stride + k, sizeof(Floats));
    }
    for (std::int64_t o = 0; o < kOutputs; ++o) {
      Shorts whole;
      std::memcpy(&whole, by[o] + k, sizeof whole);
      const Floats weight = __builtin_convertvector(whole, Floats);
      for (std::int64_t r = 0; r < rows; ++r) total[r][o] += values[r] * weight;
    }
  }
  for (std::int64_t r = 0; r < rows; ++r) {
    for (std::int64_t o = 0; o < kOutputs; ++o) {
      float sum = 0;
      for (std::int64_t lane = 0; lane < kLanes; ++lane) sum += total[r][o][lane];
      sums[r * kOutputs + o] = sum;
    }
  }
}

// For 1 to kRows rows.
RECOLLECT_FOR_EACH_PROCESSOR
void Tile(const float* source, std::int64_t rows, const std::int16_t* weights, std::int64_t outputs,
          std::int64_t stride, float* sums) {
  switch (rows) {
    case 1:
      return TileOf<1>(source, weights, outputs, stride, sums);
    case 2:
      return TileOf<2>(source, weights, outputs, stride, sums);
    case 3:
      return TileOf<3>(source, weights, outputs, stride, sums);
    default:
      return TileOf<kRows>(source, weights, outputs, stride, sums);
  }
}

}  // namespace

FixedProduct::FixedProduct(const torch::Tensor& weight, const torch::Tensor& bias, float slope)
    : outputs_(weight.size(0)),
      inputs_(weight.size(1)),
      slope_(slope),
      weights_(static_cast<std::size_t>(outputs_ * Padded(inputs_)), 0) {
  const torch::Tensor plain = weight.detach().to(torch::kFloat).contiguous();
  const torch::Tensor plain_bias = bias.detach().to(torch::kFloat).contiguous();
  bias_.assign(plain_bias.data_ptr<float>(), plain_bias.data_ptr<float>() + outputs_);
  for (std::int64_t o = 0; o < outputs_; ++o) {
    const float* row = plain.data_ptr<float>() + o * inputs_;
    float greatest = 0;
    for (std::int64_t k = 0; k < inputs_; ++k) greatest = std::max(greatest, std::abs(row[k]));
    const float scale = greatest > 0 ? greatest / kGreatest : 1;
    scales_.push_back(scale);
    std::int16_t* to = weights_.data() + o * Padded(inputs_);
    for (std::int64_t k = 0; k < inputs_; ++k) {
      to[k] = static_cast<std::int16_t>(std::lround(row[k] / scale));
    }
  }
}

const dnnl::memory& FixedProduct::Run(const dnnl::memory& source) {
  OnednnStream().wait();
  const std::int64_t rows = source.get_desc().dims()[0], stride = Padded(inputs_);
  result_ =
      dnnl::memory({{rows, outputs_}, dnnl::memory::data_type::f32, dnnl::memory::format_tag::nc},
                   OnednnEngine());
  const auto* from = static_cast<const float*>(source.get_data_handle());
  std::vector<float> padded;
  if (stride != inputs_) {
    padded.assign(static_cast<std::size_t>(rows * stride), 0);
    for (std::int64_t r = 0; r < rows; ++r) {
      std::copy_n(from + r * inputs_, inputs_, padded.data() + r * stride);
    }
    from = padded.data();
  }
  auto* to = static_cast<float*>(result_.get_data_handle());
  const std::int64_t blocks = (outputs_ + kOutputs - 1) / kOutputs;
  at::parallel_for(0, blocks, 16, [&](std::int64_t begin, std::int64_t end) {
    float sums[kRows * kOutputs];
    for (std::int64_t block = begin; block < end; ++block) {
      const std::int64_t first = block * kOutputs, outputs = std::min(kOutputs, outputs_ - first);
      // The block's weights stay in the cache from one four of rows to the next.
      for (std::int64_t r = 0; r < rows; r += kRows) {
        const std::int64_t count = std::min(kRows, rows - r);
        Tile(from + r * stride, count, weights_.data() + first * stride, outputs, stride, sums);
        for (std::int64_t i = 0; i < count; ++i) {
          for (std::int64_t o = 0; o < outputs; ++o) {
            const auto at = static_cast<std::size_t>(first + o);
            const float value = sums[i * kOutputs + o] * scales_[at] + bias_[at];
            to[(r + i) * outputs_ + first + o] = value > 0 ? value : slope_ * value;
          }
        }
      }
    }
  });
  return result_;
}

}  // namespace recollect::cnn
