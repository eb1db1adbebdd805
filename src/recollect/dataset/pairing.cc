#include "recollect/dataset/pairing.h"

namespace recollect {

std::vector<FramePair> PairsWithin(const Lap& live, const Lap& key, double max_distance_m,
                                   double max_angle_rad) {
  if (live.world != key.world) return {};
  const Track live_track = MakeTrack(live), key_track = MakeTrack(key);
  std::vector<Eigen::Vector3d> key_positions;
  for (std::size_t k = 0; k < key.frames.size(); ++k) {
    key_positions.push_back(key.WorldFromCamera(k).translation());
  }
  std::vector<FramePair> pairs;
  for (std::size_t l = 0; l < live.frames.size(); ++l) {
    const Eigen::Vector3d position = live.WorldFromCamera(l).translation();
    for (std::size_t k = 0; k < key.frames.size(); ++k) {
      if ((key_positions[k] - position).squaredNorm() <= max_distance_m * max_distance_m &&
          HeadingDifference(live_track, l, key_track, k) <= max_angle_rad) {
        pairs.push_back({l, k});
      }
    }
  }
  return pairs;
}

std::vector<FramePair> PairAlongRoute(const Lap& live, const Lap& key, bool same_lap,
                                      const PairingOptions& options) {
  const Track live_track = MakeTrack(live, options.yaw_rule);
  const Track key_track = MakeTrack(key, options.yaw_rule);
  const auto start = same_lap ? FramePair{} : CommonStart(live_track, key_track);
  if (!start) return {};
  std::vector<FramePair> pairs;
  for (const FramePair& pair :
       MatchAlongRoute(live_track, key_track, *start, options.search, options.search)) {
    const double distance =
        (live_track.positions[pair.live] - key_track.positions[pair.key]).norm();
    if (distance <= options.max_distance && (same_lap || distance >= options.min_distance)) {
      pairs.push_back(pair);
    }
  }
  return pairs;
}

}  // namespace recollect
