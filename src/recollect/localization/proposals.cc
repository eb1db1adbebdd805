#include "recollect/localization/proposals.h"

#include <algorithm>
#include <cmath>

namespace recollect {

std::vector<int> ProposePlaces(std::span<const wnn::LabelVotes> histogram,
                               std::span<const SE3> world_from_keyframe, double place_m,
                               int count) {
  constexpr std::size_t kLooked = 200;  // labels with fewer votes than these cannot matter
  histogram = histogram.first(std::min(kLooked, histogram.size()));
  const auto pose = [&](const wnn::LabelVotes& votes) -> const SE3& {
    return world_from_keyframe[static_cast<std::size_t>(votes.label)];
  };
  std::vector<std::pair<double, int>> scored;
  for (const wnn::LabelVotes& one : histogram) {
    double votes = 0;
    for (const wnn::LabelVotes& other : histogram) {
      const double distance = (pose(one).translation() - pose(other).translation()).norm();
      const bool same_way = pose(one).rotation().col(2).dot(pose(other).rotation().col(2)) > 0.5;
      if (same_way && distance < place_m) votes += (1 - distance / place_m) * other.votes;
    }
    scored.emplace_back(-votes, one.label);
  }
  std::sort(scored.begin(), scored.end());
  std::vector<int> keys;
  for (const auto& [votes, key] : scored) {
    if (static_cast<int>(keys.size()) == count) break;
    keys.push_back(key);
  }
  return keys;
}

}  // namespace recollect
