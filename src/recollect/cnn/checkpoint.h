#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "recollect/cnn/adam.h"
#include "recollect/cnn/trainer.h"

namespace recollect::cnn {

// All of a training's state but the weights and the optimiser's.
struct TrainingState {
  std::int64_t step = 0;
  double seconds_before = 0;  // spent before this run of the program
  double best_m = std::numeric_limits<double>::max();
  int without_gain = 0;      // validations since the best
  std::int64_t skipped = 0;  // steps left out because a gradient was not finite
  std::vector<CurvePoint> curve;
  CurvePoint sums;  // of the losses since the last validation
  std::int64_t sum_steps = 0;
  std::string options;  // ToJson of the training's options
};

// The options that decide what comes of a training, as JSON; file names, threads and the limit in
// minutes are not among them.
std::string ToJson(const TrainOptions& options);

// Throws Error naming the option that is out of its range.
void RequireSensible(const TrainOptions& options);

std::filesystem::path CheckpointPath(const TrainOptions& options);

// Atomic, so that a crash leaves the old checkpoint or the new one. `average`, here and below: the
// network of averaged weights, or null.
void WriteCheckpoint(const std::filesystem::path& path, const TrainingState& state,
                     const torch::nn::Module& network, const Adam& adam,
                     const torch::nn::Module* average = nullptr);

// Throws Error when the file is none of WriteCheckpoint's or was made with other options.
TrainingState ReadCheckpoint(const std::filesystem::path& path, const std::string& options,
                             torch::nn::Module& network, Adam& adam,
                             torch::nn::Module* average = nullptr);

// The curve as CSV with a line of names; nothing where `path` is empty.
void WriteCurve(const std::filesystem::path& path, const std::vector<CurvePoint>& curve);

}  // namespace recollect::cnn
