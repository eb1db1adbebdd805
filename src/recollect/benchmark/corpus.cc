#include "recollect/benchmark/corpus.h"

#include <algorithm>
#include <memory>
#include <opencv2/core.hpp>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/core/random.h"
#include "recollect/dataset/image.h"
#include "recollect/dataset/sampling.h"
#include "recollect/wnn/encoder.h"

namespace recollect {
namespace {

void Overlay(const Pattern& mask, Pattern& pattern) {
  for (std::size_t i = 0; i < mask.size(); ++i) pattern[i] ^= mask[i];
}

Pattern Dice(int neurons, std::uint64_t seed) {
  Pattern pattern(wnn::BlockWords(neurons, 1));
  for (std::size_t i = 0; i < pattern.size(); ++i) pattern[i] = SubSeed(seed, i);
  return pattern;
}

// The patterns of some frames of a lap.
class LapEncoder {
 public:
  LapEncoder(const CorpusOptions& options, ThreadPool& pool) : options_(options), pool_(pool) {}

  Pattern operator()(const Frame& frame) {
    Require(!frame.left.empty(), "lap", "has no images to measure with");
    const cv::Mat image = ReadColour(frame.left);
    if (!encoder_ || image.cols != width_ || image.rows != height_) {
      width_ = image.cols;
      height_ = image.rows;
      encoder_ = std::make_unique<wnn::Encoder>(options_.network, width_, height_, pool_);
    }
    return encoder_->Encode({image.data, image.cols, image.rows, image.channels(),
                             static_cast<std::ptrdiff_t>(image.step)});
  }

 private:
  const CorpusOptions& options_;
  ThreadPool& pool_;
  std::unique_ptr<wnn::Encoder> encoder_;
  int width_ = 0, height_ = 0;
};

}  // namespace

Corpus RandomCorpus(const CorpusOptions& options) {
  const int neurons = options.network.neurons();
  Corpus corpus{wnn::Memory(neurons), {}};
  const std::uint64_t keys = SubSeed(options.seed, 0), live = SubSeed(options.seed, 1);
  for (int i = 0; i < options.frames; ++i) {
    corpus.memory.Append(Dice(neurons, SubSeed(keys, static_cast<std::uint64_t>(i))));
  }
  for (int i = 0; i < options.live; ++i) {
    corpus.live.push_back(Dice(neurons, SubSeed(live, static_cast<std::uint64_t>(i))));
  }
  return corpus;
}

Corpus LapCorpus(const std::vector<Lap>& laps, const std::vector<Lap>& live_laps,
                 const CorpusOptions& options, ThreadPool& pool, const ProgressSink& progress) {
  LapEncoder encode(options, pool);
  std::vector<Pattern> keys, live;
  std::int64_t done = 0, total = 0;
  for (const auto* group : {&laps, &live_laps}) {
    for (const Lap& lap : *group) total += static_cast<std::int64_t>(lap.frames.size());
  }
  for (const Lap& lap : laps) {
    const std::vector<std::size_t> sampled = SampleFrames(lap, options.spacing_m);
    for (std::size_t i = 0; i < lap.frames.size(); ++i) {
      const bool key = std::binary_search(sampled.begin(), sampled.end(), i);
      if (key) keys.push_back(encode(lap.frames[i]));
      if (!key && live_laps.empty()) live.push_back(encode(lap.frames[i]));
      Report(progress, "encode", ++done, total);
    }
  }
  for (const Lap& lap : live_laps) {
    for (const Frame& frame : lap.frames) {
      live.push_back(encode(frame));
      Report(progress, "encode", ++done, total);
    }
  }
  Require(!keys.empty() && !live.empty(), "bench", "the laps leave no frame to look up",
          "name a --live lap, or one with frames between the key frames");

  Random random(options.seed);
  const auto pick = [&](const std::vector<Pattern>& from) -> const Pattern& {
    return from[static_cast<std::size_t>(random.Index(static_cast<std::int64_t>(from.size())))];
  };
  Corpus corpus{wnn::Memory(options.network.neurons()), {}};
  std::vector<Pattern> overlays;  // by road, of those that are complete
  while (corpus.memory.entries() < options.frames) {
    Pattern overlay(keys[0].size(), 0);
    if (!overlays.empty()) {
      overlay = pick(keys);
      Overlay(pick(keys), overlay);
    }
    for (const Pattern& key : keys) {
      if (corpus.memory.entries() == options.frames) break;
      Pattern pattern = key;
      Overlay(overlay, pattern);
      corpus.memory.Append(pattern);
    }
    overlays.push_back(std::move(overlay));
  }
  // The last road may be cut short: live images stay off it, unless it is the only one.
  if (overlays.size() > 1) overlays.pop_back();
  for (int i = 0; i < options.live; ++i) {
    Pattern pattern = pick(live);
    Overlay(pick(overlays), pattern);
    corpus.live.push_back(std::move(pattern));
  }
  return corpus;
}

}  // namespace recollect
