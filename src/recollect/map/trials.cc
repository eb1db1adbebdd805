#include "recollect/map/trials.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <utility>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/core/random.h"
#include "recollect/dataset/perturbation.h"
#include "recollect/map/map.h"
#include "recollect/wnn/displaced.h"
#include "recollect/wnn/entry_set.h"

namespace recollect {
namespace {

constexpr double kLapBreak = 3;   // spacings
constexpr double kLoop = 2;       // spacings
constexpr double kSight = 4;      // spacings from one another that key frames see one scene
constexpr int kVisitLength = 10;  // entries within which another visit changes
constexpr int kRun = 20;          // entries that calibration looks for one after the other
constexpr double kAlike = 0.5;    // cosine of the angle between views of one place
constexpr int kPass = 10;         // entries of a lap this near each other are of one pass

double Apart(const KeyFrame& a, const KeyFrame& b) {
  return (a.world_from_camera.translation() - b.world_from_camera.translation()).norm();
}
bool LookAlike(const KeyFrame& a, const KeyFrame& b) {
  return a.world_from_camera.rotation().col(2).dot(b.world_from_camera.rotation().col(2)) > kAlike;
}

// By lap, the nearest key frames that may show the same place, one of each pass.
std::vector<int> Beside(const std::vector<KeyFrame>& frames, int key, double within) {
  const KeyFrame& frame = frames[static_cast<std::size_t>(key)];
  std::vector<std::pair<double, int>> near;
  for (int other = 0; other < static_cast<int>(frames.size()); ++other) {
    const KeyFrame& candidate = frames[static_cast<std::size_t>(other)];
    const double distance = Apart(candidate, frame);
    if (distance <= within && LookAlike(candidate, frame)) near.emplace_back(distance, other);
  }
  std::sort(near.begin(), near.end());
  std::vector<int> beside;
  for (const auto& [distance, other] : near) {
    const auto same_pass = [&frames, other = other](int taken) {
      return frames[static_cast<std::size_t>(taken)].lap ==
                 frames[static_cast<std::size_t>(other)].lap &&
             std::abs(taken - other) <= kPass;
    };
    if (same_pass(key) || std::any_of(beside.begin(), beside.end(), same_pass)) continue;
    beside.push_back(other);
  }
  std::sort(beside.begin(), beside.end());
  return beside;
}

// Key frames that look the same way, at most so many spacings along the road.
std::vector<wnn::Route::Along> Along(const std::vector<KeyFrame>& frames, int key, double spacing) {
  const KeyFrame& frame = frames[static_cast<std::size_t>(key)];
  const Eigen::Vector3d ahead = frame.world_from_camera.rotation().col(2);
  std::vector<wnn::Route::Along> along;
  for (int other = 0; other < static_cast<int>(frames.size()); ++other) {
    const KeyFrame& candidate = frames[static_cast<std::size_t>(other)];
    if (Apart(candidate, frame) > kSight * spacing || !LookAlike(candidate, frame)) continue;
    const double places =
        (candidate.world_from_camera.translation() - frame.world_from_camera.translation())
            .dot(ahead) /
        spacing;
    if (std::abs(places) <= wnn::Route::kAlong) along.push_back({other, places});
  }
  return along;
}

// Takes a place, those beside it and `far` places either way of all of them out of `allowed`.
void TakeAway(const wnn::Route& route, int place, int far, std::vector<bool>& allowed) {
  std::vector<int> centres = route.beside[static_cast<std::size_t>(place)];
  centres.push_back(place);
  for (const int centre : centres) {
    for (const auto& along : {route.next, route.before}) {
      int at = centre;
      for (int i = 0; i <= far && at >= 0; ++i, at = along[static_cast<std::size_t>(at)]) {
        allowed[static_cast<std::size_t>(at)] = false;
      }
    }
  }
}

}  // namespace

wnn::Route RouteOf(const Map& map) {
  std::vector<KeyFrame> frames;
  for (int key = 0; key < map.size(); ++key) frames.push_back(map.At(key));
  return RouteOf(frames, map.description().spacing_m);
}

wnn::Route RouteOf(const std::vector<KeyFrame>& frames, double spacing_m) {
  const auto size = static_cast<int>(frames.size());
  wnn::Route route = wnn::ChainRoute(size);
  const double spacing = std::max(spacing_m, 0.1);
  int first = 0;  // of the lap
  for (int key = 0; key < size; ++key) {
    const auto i = static_cast<std::size_t>(key);
    route.beside[i] = Beside(frames, key, spacing);
    route.along[i] = Along(frames, key, spacing);
    const bool ends = key + 1 == size || frames[i + 1].lap != frames[i].lap;
    if (!ends && Apart(frames[i], frames[i + 1]) <= kLapBreak * spacing) continue;
    route.next[i] = -1;
    if (key + 1 < size) route.before[i + 1] = -1;
    if (!ends) continue;
    const auto start = static_cast<std::size_t>(first);
    if (key - first > 2 * kLoop && Apart(frames[i], frames[start]) <= kLoop * spacing &&
        LookAlike(frames[i], frames[start])) {
      route.next[i] = first;
      route.before[start] = key;
    }
    first = key + 1;
  }
  return route;
}

std::vector<wnn::Trial> MakeTrials(const Mapped& mapped, wnn::Encoder& encoder, ThreadPool& pool,
                                   const TrialOptions& options, const ProgressSink& progress) {
  const wnn::Route& route = mapped.route;
  std::vector<wnn::Trial> trials;
  for (int entry = 0; entry < route.places(); ++entry) {
    if (entry / options.run % options.stride != 0) continue;
    const auto e = static_cast<std::size_t>(entry);
    std::vector<int> seen;  // as other laps did
    std::copy_if(
        route.beside[e].begin(), route.beside[e].end(), std::back_inserter(seen),
        [&](int other) { return mapped.lap[static_cast<std::size_t>(other)] != mapped.lap[e]; });
    const bool alone = seen.empty();
    cv::Mat image = mapped.image(entry);
    if (alone) {
      image =
          Perturbed(image, VisitAlong(options.seed, entry, kVisitLength), SubSeed(options.seed, e));
    }
    const wnn::ImageView view{image.data, image.cols, image.rows, 3,
                              static_cast<std::ptrdiff_t>(image.step)};
    std::vector<bool> allowed(static_cast<std::size_t>(route.places()));
    for (std::size_t i = 0; i < allowed.size(); ++i) {
      allowed[i] = alone ? !options.leave_out || i != e : mapped.lap[i] != mapped.lap[e];
    }
    const auto ask = [&](bool nowhere) {
      wnn::EntrySet set(mapped.memory);
      wnn::Trial trial;
      if (!nowhere) trial.place = entry;
      trial.copy = alone;
      bool found = nowhere;  // whether there is anything to find
      for (int i = 0; i < route.places(); ++i) {
        const bool may = allowed[static_cast<std::size_t>(i)];
        if (may) set.Allow(i);
        // Places that were taken away are named by the votes of those around them.
        if (nowhere || !route.WithinOne(entry, i)) continue;
        trial.right.push_back(i);
        found = found || may;
      }
      if (!nowhere) trial.exact = seen;
      if (set.size() == 0 || !found) return;
      wnn::SearchOptions search;
      search.allowed = &set;
      wnn::Recollection one = wnn::RecollectImage(mapped.memory, encoder, view, pool, search);
      trial.histogram = std::move(one.histogram);
      trial.neurons = one.neurons_read;
      trials.push_back(std::move(trial));
    };
    ask(false);
    if (options.nowhere) {
      TakeAway(route, entry, options.far, allowed);
      ask(true);
    }
    Report(progress, "trials", entry + 1, route.places());
  }
  return trials;
}

void CalibrateRecognition(const std::filesystem::path& file, ThreadPool& pool,
                          const ProgressSink& progress, int trials) {
  wnn::Calibration calibration;
  {
    const Map map = Map::Open(file);
    Require(map.size() >= 3 && trials >= 1, file.string(),
            fmt::format("{} key frames are too few to tell what votes are worth", map.size()));
    const MapDescription& description = map.description();
    const wnn::Route route = RouteOf(map);
    std::vector<int> laps;
    for (int key = 0; key < map.size(); ++key) laps.push_back(static_cast<int>(map.At(key).lap));
    wnn::Encoder encoder(description.network, description.camera.left.width,
                         description.camera.left.height, pool);
    const Mapped mapped{map.memory(), route, laps, [&](int entry) { return map.Image(entry); }};
    const int stride = (map.size() + trials - 1) / trials;
    calibration = wnn::Calibrate(
        route,
        MakeTrials(mapped, encoder, pool,
                   {.stride = stride, .run = kRun, .seed = description.network.seed}, progress));
  }
  SetRecognition(file, calibration);
}

}  // namespace recollect
