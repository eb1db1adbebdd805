#pragma once

#include <span>
#include <string>
#include <vector>

#include "recollect/cnn/pair_data.h"
#include "recollect/cnn/train_options.h"

namespace recollect::cnn {

struct TrainingData {
  PairData train, valid;
  std::vector<std::size_t> quick_valid;  // numbers of the validation pairs used during training
  std::vector<std::string> laps;
  std::string validated_on;  // in words
};

// What Train trains and validates on.
TrainingData LoadTrainingData(std::span<const Lap> laps, std::span<const Lap> valid,
                              const TrainOptions& options, ThreadPool& pool,
                              const ProgressSink& progress);

// Cuts the road into blocks of 40 x 40 m and takes `share` of those, at least one, from `all`:
// pairs with both frames in these become the second result, pairs with neither stay, the rest is
// dropped. Throws Error when that leaves one of them without pairs.
std::pair<PairData, PairData> SplitRoad(const PairData& all, double share, std::uint64_t seed);

}  // namespace recollect::cnn
