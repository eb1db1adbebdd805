#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace recollect::cnn {

struct SolverOptions {
  int iterations = 5;
  // A residual of this size, in x and y, halves a sighting's weight, one of three times a tenth.
  double outlier = 0.03;
  // Standard deviations of a motion before anything is seen; they hold the answer near "no motion"
  // where little is known. Of x and y a sighting of weight 1 knows no better than `sighting_sd`.
  double prior_rotation_sd = 0.1, prior_translation_sd = 4, sighting_sd = 0.03;
};

// SolveMotion (motion_solver.h) of one pair without gradients, in one pass over the cells an
// iteration. points [3, count], seen [2, count], weight [count], each in row order; the answer is
// keyframe_from_live.
Eigen::Matrix<double, 3, 4> SolveCells(const float* points, const float* seen, const float* weight,
                                       std::int64_t count, const SolverOptions& options);

}  // namespace recollect::cnn
