#pragma once

#include <span>
#include <vector>

#include "recollect/geometry/se3.h"
#include "recollect/wnn/committee.h"

namespace recollect {

// Key frames worth a look, most likely first. The committee votes for key frames, but each place
// has several, from every lap that passed it: each candidate is judged by the votes of all key
// frames within place_m of it that look its way. At most `count`.
std::vector<int> ProposePlaces(std::span<const wnn::LabelVotes> histogram,
                               std::span<const SE3> world_from_keyframe, double place_m, int count);

}  // namespace recollect
