#pragma once

#include <filesystem>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "recollect/core/progress.h"
#include "recollect/map/map.h"
#include "recollect/wnn/calibration.h"
#include "recollect/wnn/encoder.h"
#include "recollect/wnn/memory.h"

namespace recollect {

class ThreadPool;

// The places of a map: one a key frame, ahead of each other as their lap went, beside each other
// where key frames of different laps, or passes of one lap more than ten key frames later, lie
// closest, at most a spacing apart and looking less than 60 degrees away from one another. Along
// the road lie those that look so and are at most 4 spacings apart, of any lap. Laps end where two
// key frames are more than 3 spacings apart; one whose end lies within 2 spacings of its start goes
// on there.
wnn::Route RouteOf(const Map& map);
// The same of key frames in the order they were learnt, those of a lap together.
wnn::Route RouteOf(const std::vector<KeyFrame>& frames, double spacing_m);

// What a memory has learnt, with the images it learnt it from. Entry, label and place are one.
struct Mapped {
  const wnn::Memory& memory;
  const wnn::Route& route;
  std::vector<int> lap;                     // by entry
  std::function<cv::Mat(int entry)> image;  // 8-bit B, G, R
};

struct TrialOptions {
  int stride = 1;       // every so many-th run of entries is looked for,
  int run = 1;          // so many of them that follow each other
  bool nowhere = true;  // each once more with its place and `far` places around it taken away
  int far = 10;
  bool leave_out = false;  // of what no other lap saw, the image itself may not be found
  std::uint64_t seed = 1;
};

// Trials from mapped images alone: each is looked for among the entries of all other laps. What no
// other lap saw is perturbed (dataset/perturbation.h) and looked for among all entries.
std::vector<wnn::Trial> MakeTrials(const Mapped& mapped, wnn::Encoder& encoder, ThreadPool& pool,
                                   const TrialOptions& options = {},
                                   const ProgressSink& progress = {});

// Measures what votes are worth in a map (wnn::Calibrate) by such trials, at most about `trials`
// mapped images, evenly spread, and writes it into the map. Throws Error where the map has fewer
// than three key frames.
void CalibrateRecognition(const std::filesystem::path& file, ThreadPool& pool,
                          const ProgressSink& progress = {}, int trials = 400);

}  // namespace recollect
