#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "recollect/dataset/lap.h"
#include "recollect/evaluation/place_trials.h"

namespace recollect {

struct RecognitionBenchOptions {
  int images = 40;  // live ones, evenly spread over the lap
  int threads = 0;
  std::uint64_t seed = 1;
};

// Both configurations of the weightless network (docs/recognition.md) on the same key frames and
// live images, by turns: {vibgl,recollect}.{encode_ms,total_ms}, medians over the images of reading
// patterns from an image and of all that recollects it; .map_bytes an image; ratio.{time,map},
// recollect's over vibgl's; key_frames. Throws Error where the live lap has no images or they are
// not of the key frames' size.
nlohmann::json RunRecognitionBench(const PlaceImages& places, const Lap& live,
                                   const RecognitionBenchOptions& options = {});
std::string DescribeRecognitionBench(const nlohmann::json& figures);

}  // namespace recollect
