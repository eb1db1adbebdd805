#pragma once

#include <cstdint>
#include <vector>

namespace recollect::cnn {

// A convolution over a few cells as one matrix product: which rows and which columns of the matrix
// there are. Outputs that see nothing but padding have no row (they are the bias), and kernel cells
// that meet nothing but padding no columns: 3 x 3 over 2 x 3 cells with stride 2 leaves a third of
// the weights out, over 1 x 2 cells seven ninths.
struct ConvolutionTaps {
  std::int64_t rows = 0, columns = 0;  // of the output
  // The kernel's cells, in row order, from the first to the last that meets the input.
  std::int64_t first_tap = 0, taps = 0;
  std::vector<std::int64_t> outputs;  // cells of the output that see any of the input, in order
  // For each of those and each tap the input's cell in row order, rows * columns of the input
  // where that is padding.
  std::vector<std::int64_t> sources;

  static ConvolutionTaps Of(std::int64_t input_rows, std::int64_t input_columns,
                            std::int64_t kernel_rows, std::int64_t kernel_columns,
                            std::int64_t stride, std::int64_t padding);
};

}  // namespace recollect::cnn
