#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "recollect/cnn/model_info.h"
#include "recollect/cnn/pair_data.h"
#include "recollect/cnn/pose_network.h"

namespace recollect::cnn {

// Errors of a network pair by pair, in the order of the pairs given. Metres, degrees.
struct PairErrors {
  std::vector<double> position_m, heading_deg;
  std::vector<double> no_motion_m, no_motion_heading_deg;

  PairFigures Figures() const;
};

// Every pair of `data` numbered in `chosen`; all of them where that is empty.
PairErrors EvaluatePairs(const PoseNetwork& network, const PairData& data,
                         std::span<const std::size_t> chosen = {},
                         const ProgressSink& progress = {});

}  // namespace recollect::cnn
