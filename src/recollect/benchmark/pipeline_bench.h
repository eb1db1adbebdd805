#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "recollect/dataset/lap.h"
#include "recollect/localization/localizer.h"

namespace recollect {

struct PipelineBenchOptions {
  int images = 100;  // evenly spread over the lap
  int warm_up = 3;   // localised before the clock counts
};

// Milliseconds from image file to pose, by step: steps.STEP.{p50,p99}, where `geometry` is features
// and verification together, and cpu_ms, the processor time of all threads, an image on average.
nlohmann::json RunPipelineBench(Localizer& localizer, const Lap& live,
                                const PipelineBenchOptions& options = {});
std::string DescribePipelineBench(const nlohmann::json& figures);

}  // namespace recollect
