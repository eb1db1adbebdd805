#pragma once

#include <cstddef>
#include <vector>

#include "recollect/dataset/lap.h"

namespace recollect {

// A live frame and a key frame: indices into the frames of the two laps they were made from.
struct FramePair {
  std::size_t live = 0, key = 0;
  bool operator==(const FramePair&) const = default;
};

// Every live frame with every key frame whose camera is at most `max_distance_m` away and whose
// heading differs by at most `max_angle_rad`; in order of live, then key. The frames must share a
// world. A lap paired with itself gives each frame with itself too, and each pair both ways round.
std::vector<FramePair> PairsWithin(const Lap& live, const Lap& key, double max_distance_m,
                                   double max_angle_rad);

}  // namespace recollect
