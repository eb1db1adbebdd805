#include "recollect/dataset/track.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "recollect/core/error.h"

namespace recollect {
namespace {

constexpr double kOncoming = std::numbers::pi / 2;

}  // namespace

Track MakeTrack(const Lap& lap, YawRule rule) {
  Require(rule == YawRule::kShortest || lap.world_up == Eigen::Vector3d::UnitZ(), lap.name,
          "yaws as published need a world with z up");
  Track track;
  for (std::size_t i = 0; i < lap.frames.size(); ++i) {
    track.positions.push_back(lap.frames[i].world_from_body.translation());
    track.headings.push_back(Heading(lap, i));
    if (rule == YawRule::kAsPublished) {
      track.yaws.push_back(std::atan2(track.headings.back().y(), track.headings.back().x()));
    }
  }
  return track;
}

double HeadingDifference(const Track& a, std::size_t i, const Track& b, std::size_t j) {
  if (a.yaws.empty()) return HeadingDifference(a.headings[i], b.headings[j]);
  return std::abs(a.yaws[i] - b.yaws[j]);
}

std::optional<FramePair> CommonStart(const Track& live, const Track& key) {
  constexpr std::size_t kFrames = 1000;
  // The live frame is ahead of the key frame, or within a centimetre of it.
  const auto ahead = [&](std::size_t l, std::size_t k) {
    return key.headings[k].dot(live.positions[l] - key.positions[k]) >= -0.01;
  };
  std::optional<FramePair> nearest;
  if (live.size() == 0 || key.size() == 0) return nearest;
  double smallest = 30;
  bool was_ahead = ahead(0, 0);
  for (std::size_t k = 0; k < std::min(kFrames, key.size()); ++k) {
    for (std::size_t l = 0; l < std::min(kFrames, live.size()); ++l) {
      const double distance = (live.positions[l] - key.positions[k]).norm();
      if (distance <= smallest && HeadingDifference(live, l, key, k) <= kOncoming) {
        smallest = distance;
        nearest = FramePair{l, k};
      }
      const bool is_ahead = ahead(l, k);
      if (smallest < 1 && is_ahead != was_ahead) return nearest;
      was_ahead = is_ahead;
    }
  }
  return nearest;
}

std::vector<double> ArcLengths(const Track& track, std::size_t start) {
  std::vector<double> arcs(track.size(), 0);
  double sum = 0;
  for (std::size_t n = 1; n < track.size(); ++n) {
    const std::size_t i = (start + n) % track.size();
    const std::size_t before = (start + n - 1) % track.size();
    arcs[i] = sum += (track.positions[i] - track.positions[before]).norm();
  }
  return arcs;
}

std::vector<FramePair> MatchAlongRoute(const Track& live, const Track& key, FramePair start,
                                       double max_distance, double max_arc_difference) {
  const std::vector<double> live_arcs = ArcLengths(live, start.live);
  const std::vector<double> key_arcs = ArcLengths(key, start.key);
  std::vector<FramePair> matches;
  for (std::size_t l = 0; l < live.size(); ++l) {
    double distance = max_distance, arc_difference = max_arc_difference;
    std::optional<std::size_t> nearest;
    for (std::size_t k = 0; k < key.size(); ++k) {
      const double arc = std::abs(live_arcs[l] - key_arcs[k]);
      if (arc > arc_difference) continue;
      const double d = (live.positions[l] - key.positions[k]).norm();
      if (d > distance || HeadingDifference(live, l, key, k) > kOncoming) continue;
      distance = d;
      arc_difference = arc;
      nearest = k;
    }
    if (nearest) matches.push_back({l, *nearest});
  }
  return matches;
}

}  // namespace recollect
