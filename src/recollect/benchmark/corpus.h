#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "recollect/core/progress.h"
#include "recollect/dataset/lap.h"
#include "recollect/wnn/memory.h"
#include "recollect/wnn/network.h"

namespace recollect {

class ThreadPool;

using Pattern = std::vector<std::uint64_t>;

// What a search is measured on: the patterns of a map and of live images, of any number of key
// frames.
struct Corpus {
  wnn::Memory memory{1};
  std::vector<Pattern> live;
};

struct CorpusOptions {
  int frames = 4415;     // key frames of the map
  int live = 200;        // live images
  double spacing_m = 5;  // between key frames of a lap
  wnn::NetworkOptions network;
  std::uint64_t seed = 1;
};

// Random bits: nothing resembles anything.
Corpus RandomCorpus(const CorpusOptions& options);

// Key frames sampled from `laps`; live images drawn from `live_laps` or, where there are none,
// from the frames of `laps` that are no key frames. Where the laps have too few key frames, the
// map goes on along made-up roads: a road is the laps again with the difference of two far images
// of theirs laid over every pattern. Along a road all distances are the real ones; between roads
// they are those of unlike places. Live images lie on all roads. Throws Error when no frame is
// left to be live or a lap has no images.
Corpus LapCorpus(const std::vector<Lap>& laps, const std::vector<Lap>& live_laps,
                 const CorpusOptions& options, ThreadPool& pool, const ProgressSink& progress = {});

}  // namespace recollect
