#pragma once

#include <numbers>
#include <vector>

#include "recollect/dataset/track.h"

namespace recollect {

// Every live frame with every key frame whose camera is at most `max_distance_m` away and whose
// heading differs by at most `max_angle_rad`; in order of live, then key. Laps of different worlds
// have no pairs. A lap paired with itself gives each frame with itself too, and each pair both ways
// round.
std::vector<FramePair> PairsWithin(const Lap& live, const Lap& key, double max_distance_m,
                                   double max_angle_rad);

// How the paper pairs live frames (sampled at 1 m) with key frames (sampled at 5 m). Metres.
struct PairingOptions {
  double search = 10;       // a key frame further away, by air or along the route, is no match
  double max_distance = 5;  // matched pairs further apart than this are dropped
  double min_distance = 1;  // and so are those closer than this, unless of one lap
  YawRule yaw_rule = YawRule::kShortest;
};

// For each live frame the key frame that MatchAlongRoute gives, as far as the options allow; empty
// where the laps have no common start. One lap paired with itself has its first frames as start.
std::vector<FramePair> PairAlongRoute(const Lap& live, const Lap& key, bool same_lap,
                                      const PairingOptions& options = {});

}  // namespace recollect
