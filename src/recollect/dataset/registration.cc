#include "recollect/dataset/registration.h"

#include <limits>
#include <map>
#include <numbers>
#include <numeric>

#include "recollect/core/error.h"
#include "recollect/dataset/sampling.h"

namespace recollect {
namespace {

// A lap up to its loop's end, thinned: the frames kept, and the track of those.
struct Thinned {
  std::vector<std::size_t> frames;
  Track track;
};

Thinned Thin(const Lap& lap, double spacing, double radius, YawRule rule) {
  std::vector<std::size_t> loop(LoopEnd(lap, radius));
  std::iota(loop.begin(), loop.end(), 0);
  const Lap head = Subset(lap, loop);
  Thinned thinned;
  // Half a turn as limit: only distance counts (and the jump of yaws as published).
  thinned.frames = SampleFrames(head, spacing, std::numbers::pi, rule);
  thinned.track = MakeTrack(Subset(head, thinned.frames), rule);
  return thinned;
}

// A frame of a thinned lap (live) with its place (key).
std::vector<FramePair> Label(const Lap& lap, const Track& track, const Track& places,
                             double max_distance) {
  const auto start = CommonStart(track, places);
  Require(start.has_value(), lap.name, "never comes near the start of the registration lap");
  return MatchAlongRoute(track, places, *start, max_distance,
                         std::numeric_limits<double>::infinity());
}

// The end of the run of equal places that begins at `begin`.
std::size_t RunEnd(const std::vector<FramePair>& labels, std::size_t begin) {
  std::size_t end = begin;
  while (end < labels.size() && labels[end].key == labels[begin].key) ++end;
  return end;
}

// Where the test was at each place; the last pass counts where it came by more than once.
std::map<std::size_t, Eigen::Vector3d> Centroids(const Track& track,
                                                 const std::vector<FramePair>& labels) {
  std::map<std::size_t, Eigen::Vector3d> centroids;
  for (std::size_t begin = 0, end = 0; begin < labels.size(); begin = end) {
    end = RunEnd(labels, begin);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = begin; i < end; ++i) sum += track.positions[labels[i].live];
    centroids[labels[begin].key] = sum / static_cast<double>(end - begin);
  }
  return centroids;
}

PlacedFrames OnePerPass(const Thinned& lap, std::vector<FramePair> labels,
                        const std::map<std::size_t, Eigen::Vector3d>& centroids) {
  std::erase_if(labels, [&](const FramePair& label) { return !centroids.contains(label.key); });
  PlacedFrames placed;
  for (std::size_t begin = 0, end = RunEnd(labels, 0); end < labels.size();
       begin = end, end = RunEnd(labels, begin)) {
    const std::size_t place = labels[begin].key;
    double smallest = std::numeric_limits<double>::infinity();
    std::size_t nearest = begin;
    for (std::size_t i = begin + 1; i < end; ++i) {
      const double distance = (lap.track.positions[labels[i].live] - centroids.at(place)).norm();
      if (distance < smallest) {
        smallest = distance;
        nearest = i;
      }
    }
    if (nearest == begin) continue;
    placed.frames.push_back(lap.frames[labels[nearest].live]);
    placed.places.push_back(place);
  }
  return placed;
}

}  // namespace

std::size_t LoopEnd(const Lap& lap, double radius) {
  if (lap.frames.empty()) return 0;
  const auto position = [&](std::size_t i) { return lap.frames[i].world_from_body.translation(); };
  std::size_t end = lap.frames.size() - 1;
  double before = 0;
  for (std::size_t i = 1; i < lap.frames.size(); ++i) {
    const double distance = (position(i) - position(0)).norm();
    if (before - distance > 0.1 && distance <= radius) end = i;
    before = distance;
  }
  return end;
}

Registration RegisterPlaces(const Lap& reference, const Lap& test,
                            const std::vector<const Lap*>& train,
                            const RegistrationOptions& options) {
  const double place_spacing = options.place_spacing, frame_spacing = options.frame_spacing;
  const Thinned places = Thin(reference, place_spacing, place_spacing, options.yaw_rule);
  Registration registration;
  registration.places = places.frames;

  const Thinned live = Thin(test, frame_spacing, frame_spacing, options.yaw_rule);
  const auto labels = Label(test, live.track, places.track, options.max_distance);
  for (const FramePair& label : labels) {
    registration.test.frames.push_back(live.frames[label.live]);
    registration.test.places.push_back(label.key);
  }
  const auto centroids = Centroids(live.track, labels);
  for (const Lap* lap : train) {
    const Thinned thinned = Thin(*lap, frame_spacing, place_spacing, options.yaw_rule);
    registration.train.push_back(OnePerPass(
        thinned, Label(*lap, thinned.track, places.track, options.max_distance), centroids));
  }
  return registration;
}

}  // namespace recollect
