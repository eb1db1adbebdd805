#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "recollect/core/progress.h"
#include "recollect/dataset/lap.h"
#include "recollect/depth/matcher.h"

namespace recollect::stereo {

struct LapDepthResult {
  std::int64_t made = 0;           // depth images written now
  std::int64_t kept = 0;           // that an earlier run had written
  std::int64_t without_right = 0;  // frames that have no right image, so no depth
  std::vector<std::string> warnings;
};

// Writes the depth image (WriteDepth) of each frame of a lap that has a right image into `out`, by
// the name of its left image; frames in parallel, the same bits for any number of threads. `out`
// says in depth.txt how it was made; begun again with the same options, what is there is kept. A
// few pairs are checked first (pair_check.h). Throws Error where the lap has no right images or no
// baseline, a pair is swapped, an image is bad, or `out` holds depth made otherwise, such as a
// sensor's.
LapDepthResult WriteLapDepth(const Lap& lap, const std::filesystem::path& out,
                             const MatchOptions& options, ThreadPool& pool,
                             const ProgressSink& progress = {});

}  // namespace recollect::stereo
