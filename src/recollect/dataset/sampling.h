#pragma once

#include <cstddef>
#include <numbers>
#include <vector>

#include "recollect/dataset/track.h"

namespace recollect {

// The frames of a lap that stay when it is thinned to one every `spacing_m` metres: the first, and
// each that is at least so far from the last kept one, or whose heading differs from it by at
// least `max_yaw_rad`. Indices into lap.frames, increasing.
std::vector<std::size_t> SampleFrames(const Lap& lap, double spacing_m,
                                      double max_yaw_rad = 10 * std::numbers::pi / 180,
                                      YawRule rule = YawRule::kShortest);

}  // namespace recollect
