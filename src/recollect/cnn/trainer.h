#pragma once

#include <span>
#include <string>
#include <vector>

#include "recollect/cnn/model_info.h"
#include "recollect/cnn/pair_errors.h"
#include "recollect/cnn/train_options.h"
#include "recollect/core/progress.h"
#include "recollect/dataset/lap.h"

namespace recollect::cnn {

// One validation: means over the steps since the last one, then the errors found.
struct CurvePoint {
  std::int64_t step = 0;
  double epoch = 0, seconds = 0, learning_rate = 0;
  double loss = 0, projection_m = 0, correspondence = 0, depth = 0, likelihood = 0;
  double train_position_m = 0;  // over the pairs trained on, as they were seen
  double valid_position_m = 0, valid_heading_deg = 0;
};

struct TrainResult {
  ModelInfo model;  // of the best network, which is in TrainOptions::out
  std::int64_t steps = 0;
  double seconds = 0;
  std::vector<CurvePoint> curve;
};

// Trains a network on all pairs of `laps` (crossed with each other and themselves), validated on
// live frames of `valid` against key frames of `laps`, or without those on a share of the road
// that is kept out of the training (TrainOptions::validation_share). The network with the least
// mean position error there is the result.
//
// Runs on two threads and a loader's with the same seed are alike but not equal: floating-point
// sums depend on the number of threads, and a limit in minutes on the machine's speed. With one
// number of threads and no such limit they are equal, and so is a training that was resumed.
//
// Memory: about 200 kB a frame (see StoredFrame), twice for frames that are both trained on and
// validated against, and for batch 24 some 2.5 GB (compact) or 7 GB (A).
// With several ranks the first writes all files and returns the result, the others the number of
// steps; the pairs of each step are shared out among them.
// Steps whose loss or gradient is not finite are left out.
//
// Throws Error as LoadPairs does, for options out of range, for a checkpoint of other options,
// where a file cannot be written (an earlier checkpoint stays whole), and after writing a
// checkpoint where `options.stop` said so, a rank was lost or many steps in a row had to be left
// out.
TrainResult Train(std::span<const Lap> laps, std::span<const Lap> valid,
                  const TrainOptions& options, const ProgressSink& progress = {});

}  // namespace recollect::cnn
