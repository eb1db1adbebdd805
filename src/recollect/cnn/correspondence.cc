#include "recollect/cnn/correspondence.h"

#include <array>

namespace recollect::cnn {

torch::Tensor PlaceMap(const Grid& grid, std::int64_t batch, const torch::TensorOptions& options) {
  const torch::Tensor x =
      torch::linspace(-1, 1, grid.columns, options).view({1, 1, 1, grid.columns});
  const torch::Tensor y = torch::linspace(-1, 1, grid.rows, options).view({1, 1, grid.rows, 1});
  const std::array<std::int64_t, 4> shape = {batch, 1, grid.rows, grid.columns};
  return torch::cat({x.expand(shape), y.expand(shape)}, 1);
}

Correlation CorrelateByTensors(const torch::Tensor& live, const torch::Tensor& key,
                               const Grid& grid) {
  const torch::Tensor scores = torch::bmm(live.transpose(1, 2), key);
  const torch::Tensor best = scores.argmax(2);
  const torch::Tensor column = best.remainder(grid.columns).clamp(2, grid.columns - 3);
  const torch::Tensor row = best.div(grid.columns, "floor").clamp(2, grid.rows - 3);
  const torch::Tensor reach = torch::arange(-2, 3, best.options());
  const torch::Tensor around =
      (reach.unsqueeze(1) * grid.columns + reach.unsqueeze(0)).flatten();  // [25]
  const torch::Tensor places = (row * grid.columns + column).unsqueeze(2) + around;
  return {scores.logsumexp(2), scores.gather(2, places), column.to(live.options()),
          row.to(live.options())};
}

PeakFlow ReadPeaks(const Correlation& correlation, const Grid& grid) {
  const torch::TensorOptions options = correlation.window.options();
  const torch::Tensor cells = torch::arange(grid.cells(), options);
  const torch::Tensor reach = torch::arange(-2, 3, options);
  const torch::Tensor weights = correlation.window.softmax(2);
  const torch::Tensor columns =
      (weights * reach.repeat({5})).sum(2) + correlation.columns - cells.remainder(grid.columns);
  const torch::Tensor rows = (weights * reach.repeat_interleave(5)).sum(2) + correlation.rows -
                             cells.div(grid.columns, "floor");
  const torch::Tensor share = (correlation.window.logsumexp(2) - correlation.total).exp();
  return {torch::stack({columns, rows}, 1), share.unsqueeze(1)};
}

TrueFlow ProjectCells(const torch::Tensor& points, const torch::Tensor& valid,
                      const torch::Tensor& motion, const Grid& grid, double fx, double fy,
                      double cx, double cy) {
  const torch::Tensor seen = torch::matmul(motion.slice(2, 0, 3), points) + motion.slice(2, 3, 4);
  const torch::Tensor z = seen.select(1, 2);
  const torch::Tensor safe_z = z.clamp_min(0.1);
  TrueFlow flow;
  flow.columns = seen.select(1, 0) / safe_z * fx + cx;
  flow.rows = seen.select(1, 1) / safe_z * fy + cy;
  flow.visible = valid & (z > 0.1) & (flow.columns >= 0) & (flow.columns <= grid.columns - 1) &
                 (flow.rows >= 0) & (flow.rows <= grid.rows - 1);
  return flow;
}

torch::Tensor CorrespondenceLoss(const torch::Tensor& live, const torch::Tensor& key,
                                 const torch::Tensor& total, const TrueFlow& truth,
                                 const Grid& grid, const Divisor& divisor) {
  // The score is linear in the key frame's feature, so the four scores around the truth, weighed
  // bilinearly, are one score: that of the feature interpolated there.
  namespace F = torch::nn::functional;
  const torch::Tensor places =
      torch::stack({truth.columns * (2.0 / static_cast<double>(grid.columns - 1)) - 1.0,
                    truth.rows * (2.0 / static_cast<double>(grid.rows - 1)) - 1.0},
                   2)
          .unsqueeze(1);  // [B, 1, N, 2]
  const torch::Tensor there =
      F::grid_sample(key.view({key.size(0), key.size(1), grid.rows, grid.columns}), places,
                     F::GridSampleFuncOptions().align_corners(true).padding_mode(torch::kBorder));
  const torch::Tensor expected = (live * there.squeeze(2)).sum(1);
  return WeightedMean(total - expected, truth.visible.to(total.scalar_type()), divisor);
}

}  // namespace recollect::cnn
