#include <ATen/Parallel.h>
#include <torch/torch.h>

#include <algorithm>
#include <cstdint>

#include "recollect/cnn/correspondence.h"
#include "recollect/cnn/softmax_rows.h"
#include "recollect/core/error.h"

namespace recollect::cnn {
namespace {

constexpr std::int64_t kReach = 2;  // of the window around a peak, in cells
constexpr std::int64_t kSide = 2 * kReach + 1;

// First cell of the window around `best`. The window keeps inside the grid, so it is always whole.
std::int64_t WindowStart(std::int64_t best, const Grid& grid) {
  const std::int64_t column =
      std::clamp(best % grid.columns, kReach, grid.columns - 1 - kReach) - kReach;
  const std::int64_t row = std::clamp(best / grid.columns, kReach, grid.rows - 1 - kReach) - kReach;
  return row * grid.columns + column;
}

// The batch is shared out among the threads, a pair's live cells are taken in blocks: a block's
// scores stay in the cache from one operation on them to the next.
constexpr std::int64_t kBlock = 64;

template <typename Body>
void ForEachPair(std::int64_t batch, const Body& body) {
  at::parallel_for(0, batch, 1, [&](std::int64_t begin, std::int64_t end) {
    const torch::NoGradGuard no_gradients;
    for (std::int64_t i = begin; i < end; ++i) body(i);
  });
}

template <typename Body>
void ForEachBlock(std::int64_t cells, const Body& body) {
  for (std::int64_t from = 0; from < cells; from += kBlock) {
    body(from, std::min(kBlock, cells - from));
  }
}

class CorrelateFunction : public torch::autograd::Function<CorrelateFunction> {
 public:
  static torch::autograd::variable_list forward(torch::autograd::AutogradContext* context,
                                                const torch::Tensor& live, const torch::Tensor& key,
                                                std::int64_t rows, std::int64_t columns) {
    const Grid grid{rows, columns};
    const std::int64_t batch = live.size(0), cells = grid.cells();
    torch::Tensor total = torch::empty({batch, cells}, live.options());
    torch::Tensor window = torch::empty({batch, cells, kSide * kSide}, live.options());
    torch::Tensor starts = torch::empty({batch, cells}, torch::kLong);
    AT_DISPATCH_FLOATING_TYPES(live.scalar_type(), "Correlate", [&] {
      ForEachPair(batch, [&](std::int64_t i) {
        torch::Tensor scores = torch::empty({std::min(kBlock, cells), cells}, live.options());
        auto* start = starts.data_ptr<std::int64_t>() + i * cells;
        auto* sum = total.data_ptr<scalar_t>() + i * cells;
        auto* to = window.data_ptr<scalar_t>() + i * cells * kSide * kSide;
        ForEachBlock(cells, [&](std::int64_t first, std::int64_t count) {
          torch::Tensor rows_of_block = scores.narrow(0, 0, count);
          torch::mm_out(rows_of_block, live[i].narrow(1, first, count).t(), key[i]);
          const auto* row = scores.data_ptr<scalar_t>();
          for (std::int64_t cell = first; cell < first + count; ++cell, row += cells) {
            std::int64_t best = 0;
            const scalar_t greatest = Greatest(row, cells, &best);
            sum[cell] = LogSumExp(row, cells, greatest);
            start[cell] = WindowStart(best, grid);
            for (std::int64_t r = 0; r < kSide; ++r) {
              to = std::copy_n(row + start[cell] + r * columns, kSide, to);
            }
          }
        });
      });
    });
    const torch::Tensor middle = starts + (kReach * columns + kReach);
    const torch::Tensor middle_columns = middle.remainder(columns).to(live.options());
    const torch::Tensor middle_rows = middle.div(columns, "floor").to(live.options());
    context->mark_non_differentiable({middle_columns, middle_rows});
    context->save_for_backward({live, key, total, starts});
    context->saved_data["columns"] = columns;
    return {total, window, middle_columns, middle_rows};
  }

  static torch::autograd::variable_list backward(torch::autograd::AutogradContext* context,
                                                 torch::autograd::variable_list gradients) {
    const auto saved = context->get_saved_variables();
    const torch::Tensor &live = saved[0], &key = saved[1], &total = saved[2], &starts = saved[3];
    const std::int64_t columns = context->saved_data["columns"].toInt();
    const std::int64_t batch = live.size(0), cells = live.size(2);
    const torch::Tensor total_gradient = gradients[0].contiguous();
    const torch::Tensor window_gradient = gradients[1].contiguous();
    torch::Tensor live_gradient = torch::empty_like(live), key_gradient = torch::zeros_like(key);
    AT_DISPATCH_FLOATING_TYPES(live.scalar_type(), "Correlate", [&] {
      ForEachPair(batch, [&](std::int64_t i) {
        // d total / d score is the softmax; d window / d score picks.
        torch::Tensor block = torch::empty({std::min(kBlock, cells), cells}, live.options());
        torch::Tensor live_part = live_gradient[i], key_part = key_gradient[i];
        const auto* sum = total.data_ptr<scalar_t>() + i * cells;
        const auto* scale = total_gradient.data_ptr<scalar_t>() + i * cells;
        const auto* start = starts.data_ptr<std::int64_t>() + i * cells;
        const auto* from = window_gradient.data_ptr<scalar_t>() + i * cells * kSide * kSide;
        ForEachBlock(cells, [&](std::int64_t first, std::int64_t count) {
          torch::Tensor gradient = block.narrow(0, 0, count);
          const torch::Tensor live_block = live[i].narrow(1, first, count);
          torch::mm_out(gradient, live_block.t(), key[i]);
          auto* row = block.data_ptr<scalar_t>();
          for (std::int64_t cell = first; cell < first + count; ++cell, row += cells) {
            ScaledSoftmax(row, cells, sum[cell], scale[cell]);
            for (std::int64_t r = 0; r < kSide; ++r) {
              auto* to = row + start[cell] + r * columns;
              for (std::int64_t column = 0; column < kSide; ++column) to[column] += *from++;
            }
          }
          live_part.narrow(1, first, count).copy_(torch::mm(key[i], gradient.t()));
          key_part.addmm_(live_block, gradient);
        });
      });
    });
    return {live_gradient, key_gradient, {}, {}};
  }
};

}  // namespace

Correlation Correlate(const torch::Tensor& live, const torch::Tensor& key, const Grid& grid) {
  Require(grid.rows >= kSide && grid.columns >= kSide, "CompactNetwork",
          "the image is too small: 40 x 40 pixels are the least");
  if (!live.is_cpu()) return CorrelateByTensors(live, key, grid);
  const auto out =
      CorrelateFunction::apply(live.contiguous(), key.contiguous(), grid.rows, grid.columns);
  return {out[0], out[1], out[2], out[3]};
}

}  // namespace recollect::cnn
