#pragma once

#include <torch/torch.h>

#include <cstdint>

#include "recollect/cnn/loss.h"

// Where the cells of a live image are seen in a key frame: reading it off the correlation of the
// two feature grids, and the truth to train the correlation with. Cells are numbered in row order,
// displacements are (columns, rows) in cells, B is the batch and N the number of cells.
namespace recollect::cnn {

struct Grid {
  std::int64_t rows = 0, columns = 0;
  std::int64_t cells() const { return rows * columns; }
};

// Places of the cells, columns and rows each from -1 to 1: [B, 2, rows, columns].
torch::Tensor PlaceMap(const Grid& grid, std::int64_t batch,
                       const torch::TensorOptions& options = {});

// Scores of all N key-frame cells for each of the N live cells, as far as they are of use.
struct Correlation {
  torch::Tensor total;    // [B, N]: logarithm of the sum of exp(score) over the key-frame cells
  torch::Tensor window;   // [B, N, 25]: the scores of the 5 x 5 cells around the best, row order
  torch::Tensor columns;  // [B, N]: the middle of that window; whole numbers, no gradient
  torch::Tensor rows;
};

// score(i, j) = live[:, i] . key[:, j] for features [B, C, N] of grids of 5 x 5 cells or more. The
// N x N scores are never kept, but made anew on the way back: they are by far the largest thing
// that a network of this kind would have to remember.
Correlation Correlate(const torch::Tensor& live, const torch::Tensor& key, const Grid& grid);

// The same on any device, by libtorch's operations and with all scores at once.
Correlation CorrelateByTensors(const torch::Tensor& live, const torch::Tensor& key,
                               const Grid& grid);

struct PeakFlow {
  torch::Tensor displacement;  // [B, 2, N]: key-frame place minus live place, expected
  torch::Tensor share;         // [B, 1, N]: how much of the softmax lies in the window, 0..1
};

// Reads the softmax of the scores. The expectation is taken over the window only: the small
// probabilities of many far cells would otherwise draw it to the middle.
PeakFlow ReadPeaks(const Correlation& correlation, const Grid& grid);

// For every live cell the place in the key frame where it is truly seen.
struct TrueFlow {
  torch::Tensor columns, rows;  // [B, N] in key-frame cells
  torch::Tensor visible;        // [B, N]: inside the key frame, and the live depth is known
};

// points [B, 3, N] of the live cells in the live camera's frame, metres; valid [B, N]; motion
// [B, 3, 4] = keyframe_from_live. fx, fy, cx, cy: the camera of the cell grid. Occlusion is
// ignored.
TrueFlow ProjectCells(const torch::Tensor& points, const torch::Tensor& valid,
                      const torch::Tensor& motion, const Grid& grid, double fx, double fy,
                      double cx, double cy);

// Cross-entropy of the softmax of the scores against the truth, mean over the visible cells; the
// truth is shared out bilinearly among the four cells around it. Zero where nothing is visible.
// Features as given to Correlate, total as it returned.
torch::Tensor CorrespondenceLoss(const torch::Tensor& live, const torch::Tensor& key,
                                 const torch::Tensor& total, const TrueFlow& truth,
                                 const Grid& grid, const Divisor& divisor = {});

}  // namespace recollect::cnn
