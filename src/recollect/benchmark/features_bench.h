#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "recollect/dataset/lap.h"

namespace recollect {

struct FeaturesBenchOptions {
  int images = 30;  // evenly spread over the lap
};

// Features and their matching on one thread, beside OpenCV's on the same images: milliseconds an
// image, ms.STEP.{ours,opencv} and ratio.STEP, medians, for the steps `blur` (one image of the
// scale space), `points`, `descriptors` and `match` (two images' descriptors, mutual). Points and
// descriptors of both include the scale space that they need. share_of_peak.{blur,match}: of the
// multiplications that a loop without memory reaches in the same run. The number of threads that
// OpenCV may use is one afterwards. Throws Error where the lap has no images.
nlohmann::json RunFeaturesBench(const Lap& lap, const FeaturesBenchOptions& options = {});
std::string DescribeFeaturesBench(const nlohmann::json& figures);

}  // namespace recollect
