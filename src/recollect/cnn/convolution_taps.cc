#include "recollect/cnn/convolution_taps.h"

#include <algorithm>

namespace recollect::cnn {

ConvolutionTaps ConvolutionTaps::Of(std::int64_t input_rows, std::int64_t input_columns,
                                    std::int64_t kernel_rows, std::int64_t kernel_columns,
                                    std::int64_t stride, std::int64_t padding) {
  ConvolutionTaps t;
  t.rows = (input_rows + 2 * padding - kernel_rows) / stride + 1;
  t.columns = (input_columns + 2 * padding - kernel_columns) / stride + 1;
  const std::int64_t outside = input_rows * input_columns, all = kernel_rows * kernel_columns;
  const auto source = [&](std::int64_t output, std::int64_t tap) {
    const std::int64_t row = output / t.columns * stride - padding + tap / kernel_columns;
    const std::int64_t column = output % t.columns * stride - padding + tap % kernel_columns;
    const bool inside = row >= 0 && row < input_rows && column >= 0 && column < input_columns;
    return inside ? row * input_columns + column : outside;
  };
  std::int64_t last_tap = -1;
  t.first_tap = all;
  for (std::int64_t output = 0; output < t.rows * t.columns; ++output) {
    bool sees = false;
    for (std::int64_t tap = 0; tap < all; ++tap) {
      if (source(output, tap) == outside) continue;
      sees = true;
      t.first_tap = std::min(t.first_tap, tap);
      last_tap = std::max(last_tap, tap);
    }
    if (sees) t.outputs.push_back(output);
  }
  t.taps = std::max<std::int64_t>(0, last_tap + 1 - t.first_tap);
  for (const std::int64_t output : t.outputs) {
    for (std::int64_t i = 0; i < t.taps; ++i) {
      t.sources.push_back(source(output, t.first_tap + i));
    }
  }
  return t;
}

}  // namespace recollect::cnn
