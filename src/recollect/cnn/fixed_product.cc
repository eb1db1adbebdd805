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

std::int64_t RoundedUp(std::int64_t count, std::int64_t to) { return (count + to - 1) / to * to; }

// sums[r][o] = source row r . weight row o, both `stride` numbers long; the weights of kOutputs
// rows a vector each in turn.
template <std::int64_t rows>
[[gnu::always_inline]] inline void TileOf(const float* source, const std::int16_t* weights,
                                          std::int64_t stride, float* sums) {
  constexpr std::int64_t kAhead = 8192 / sizeof(std::int16_t);  // what memory takes to answer
  Floats total[rows][kOutputs] = {};
  for (std::int64_t k = 0; k < stride; k += kLanes) {
    Floats values[rows];
    for (std::int64_t r = 0; r < rows; ++r) {
      std::memcpy(&values[r], source + r * stride + k, sizeof(Floats));
    }
    for (std::int64_t o = 0; o < kOutputs; ++o, weights += kLanes) {
      if (o % 2 == 0) __builtin_prefetch(weights + kAhead, 0, 2);  // two vectors a line
      Shorts whole;
      std::memcpy(&whole, weights, sizeof whole);
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
void Tile(const float* source, std::int64_t rows, const std::int16_t* weights, std::int64_t stride,
          float* sums) {
  switch (rows) {
    case 1:
      return TileOf<1>(source, weights, stride, sums);
    case 2:
      return TileOf<2>(source, weights, stride, sums);
    case 3:
      return TileOf<3>(source, weights, stride, sums);
    default:
      return TileOf<kRows>(source, weights, stride, sums);
  }
}

}  // namespace

FixedProduct::FixedProduct(const torch::Tensor& weight, const torch::Tensor& bias, float slope)
    : outputs_(weight.size(0)),
      inputs_(weight.size(1)),
      slope_(slope),
      weights_(static_cast<std::size_t>(RoundedUp(outputs_, kOutputs) * RoundedUp(inputs_, kLanes)),
               0) {
  const torch::Tensor plain = weight.detach().to(torch::kFloat).contiguous();
  const torch::Tensor plain_bias = bias.detach().to(torch::kFloat).contiguous();
  bias_.assign(plain_bias.data_ptr<float>(), plain_bias.data_ptr<float>() + outputs_);
  for (std::int64_t o = 0; o < outputs_; ++o) {
    const float* row = plain.data_ptr<float>() + o * inputs_;
    float greatest = 0;
    for (std::int64_t k = 0; k < inputs_; ++k) greatest = std::max(greatest, std::abs(row[k]));
    const float scale = greatest > 0 ? greatest / kGreatest : 1;
    scales_.push_back(scale);
    std::int16_t* to = weights_.data() + o / kOutputs * kOutputs * RoundedUp(inputs_, kLanes) +
                       o % kOutputs * kLanes;
    for (std::int64_t k = 0; k < inputs_; ++k) {
      to[k / kLanes * kLanes * kOutputs + k % kLanes] =
          static_cast<std::int16_t>(std::lround(row[k] / scale));
    }
  }
}

torch::Tensor FixedProduct::Run(const torch::Tensor& rows_of_source) const {
  const std::int64_t rows = rows_of_source.size(0), stride = RoundedUp(inputs_, kLanes);
  const torch::Tensor source =
      torch::constant_pad_nd(rows_of_source, {0, stride - inputs_}).contiguous();
  const torch::Tensor result = torch::empty({rows, outputs_});
  const auto* from = source.data_ptr<float>();
  auto* to = result.data_ptr<float>();
  const std::int64_t blocks = (outputs_ + kOutputs - 1) / kOutputs;
  at::parallel_for(0, blocks, 16, [&](std::int64_t begin, std::int64_t end) {
    float sums[kRows * kOutputs];
    for (std::int64_t block = begin; block < end; ++block) {
      const std::int64_t first = block * kOutputs, outputs = std::min(kOutputs, outputs_ - first);
      // The block's weights stay in the cache from one four of rows to the next.
      for (std::int64_t r = 0; r < rows; r += kRows) {
        const std::int64_t count = std::min(kRows, rows - r);
        Tile(from + r * stride, count, weights_.data() + first * stride, stride, sums);
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
  return result;
}

}  // namespace recollect::cnn
