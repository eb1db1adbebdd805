#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "recollect/core/progress.h"
#include "recollect/dataset/lap.h"
#include "recollect/evaluation/place_reliability.h"
#include "recollect/map/map.h"
#include "recollect/map/trials.h"
#include "recollect/wnn/calibration.h"
#include "recollect/wnn/encoder.h"
#include "recollect/wnn/sequence.h"

namespace recollect {

class ThreadPool;

// Place recognition by itself, without relative poses: which configuration of the weightless
// network finds places best. Nothing here reads a map file; images are kept in memory.

// Images to learn, in the order of their laps.
struct PlaceImages {
  std::vector<cv::Mat> images;   // 8-bit B, G, R, all of one size
  std::vector<KeyFrame> frames;  // where each was taken
  double spacing_m = 5;
  wnn::Route route;
};

// Key frames of laps that share a world. Throws Error on laps without images or of several sizes.
PlaceImages ReadPlaces(const std::vector<Lap>& laps, double spacing_m);
// Images of a folder without poses, one place each, as one lap.
PlaceImages ReadPlaces(const std::filesystem::path& folder);

// The weightless network once it has learnt them. `places` and `pool` must outlive it.
struct LearntPlaces {
  LearntPlaces(const PlaceImages& places, const wnn::NetworkOptions& network, ThreadPool& pool);
  const PlaceImages& places;
  wnn::Encoder encoder;
  wnn::Memory memory;
  std::vector<wnn::Trial> Trials(ThreadPool& pool, const TrialOptions& options = {},
                                 const ProgressSink& progress = {});
};

// What was answered for one live image.
struct PlaceAnswer {
  double single_m = 0;     // from the key frame answered to the truth: by the votes alone,
  double supported_m = 0;  // by support (wnn::Supported),
  double filtered_m = 0;   // and by the sequence
  // Right: within one key frame of the nearest one.
  Told single;    // by support, its probability by the calibration
  Told filtered;  // by the sequence, with its own
};
std::vector<PlaceAnswer> AnswerLive(LearntPlaces& learnt, const Lap& live, double live_spacing_m,
                                    const wnn::SequenceOptions& sequence,
                                    const wnn::Calibration& calibration, ThreadPool& pool,
                                    const ProgressSink& progress = {});

// A configuration with one thing changed.
struct Variant {
  std::string name;
  wnn::NetworkOptions network;
};
// The paper's network with each invariance alone, and the recommended one without each.
std::vector<Variant> AblationVariants();

// Mean over seeds and half the width of its 95 % interval (Student's t); 0 for one seed.
struct Estimate {
  double mean = 0, half_width = 0;
};
Estimate MeanOf(const std::vector<double>& values);

// Share of trials from mapped images alone (MakeTrials) answered right within one key frame: what
// configurations are chosen by.
double TrialScore(const PlaceImages& places, const wnn::NetworkOptions& network, int stride,
                  ThreadPool& pool);

}  // namespace recollect
