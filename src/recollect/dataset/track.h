#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "recollect/dataset/lap.h"

namespace recollect {

// How far two headings are from one another. The authors of UFES-LAPS took the plain difference of
// yaws in (-pi, pi], so that a straight road to the south looks like a turn of 2 pi wherever the
// yaw jumps; their published counts need that. It asks for a world with z up.
enum class YawRule { kShortest, kAsPublished };

// What sampling, pairing and registration look at: where the body of each frame is and heads.
struct Track {
  std::vector<Eigen::Vector3d> positions;  // metres, in the world
  std::vector<Eigen::Vector3d> headings;   // see Heading
  std::vector<double> yaws;                // about z, in (-pi, pi]; only for kAsPublished

  std::size_t size() const { return positions.size(); }
};

// Throws Error for kAsPublished when the lap's world_up is not z.
Track MakeTrack(const Lap& lap, YawRule rule = YawRule::kShortest);

// Angle between the headings of frame i of a and frame j of b, which must be made by one rule.
double HeadingDifference(const Track& a, std::size_t i, const Track& b, std::size_t j);

// A live frame and a key frame: indices into the frames of the two laps they were made from.
struct FramePair {
  std::size_t live = 0, key = 0;
  bool operator==(const FramePair&) const = default;
};

// The frames at which two drives of one route pass the same point, so that distances along the
// route can be counted from there: among the first 1,000 frames of each, the first pair, in order
// of key, then live, after which the nearest pair so far (headings within 90 degrees) is closer
// than 1 m and the live frame has passed the key frame; else the nearest within 30 m; else none.
std::optional<FramePair> CommonStart(const Track& live, const Track& key);

// For each frame its distance along the track from frame `start`, driving on from the last frame
// to the first. Metres.
std::vector<double> ArcLengths(const Track& track, std::size_t start);

// The paper's match of two drives: each live frame with at most one key frame. Keys are scanned in
// order; one is taken when its heading is within 90 degrees and neither its distance nor the
// difference of the two arc lengths (from `start`) exceeds that of the one taken before it; the
// first is held against `max_distance` and `max_arc_difference`. Metres. In order of live.
std::vector<FramePair> MatchAlongRoute(const Track& live, const Track& key, FramePair start,
                                       double max_distance, double max_arc_difference);

}  // namespace recollect
