#include "recollect/matching/mapped.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"

namespace recollect::matching {
namespace {

// Below the second figure lies the first one's share of a chi-squared variable of six degrees of
// freedom. One far quantile of some hundred answers rests on a handful of them: it is the mean of
// several.
constexpr std::pair<double, double> kChi2Of6[] = {{0.90, 10.645}, {0.91, 10.948}, {0.92, 11.283},
                                                  {0.93, 11.660}, {0.94, 12.088}, {0.95, 12.592}};
constexpr int kFewest = 20;  // answers from which a quantile is taken

}  // namespace

GeometrySource LandmarkSource(const LandmarkOptions& options) {
  return [options](const Lap& lap, std::size_t frame) {
    return ToBytes(MakeLandmarks(lap, frame, options));
  };
}

MappedFrames FramesOf(const Map& map) {
  MappedFrames frames;
  frames.camera = map.description().camera.left;
  for (int key = 0; key < map.size(); ++key) {
    frames.world_from_camera.push_back(map.At(key).world_from_camera);
    frames.lap.push_back(static_cast<int>(map.At(key).lap));
  }
  frames.landmarks = [&map](int key) {
    const auto bytes = map.Geometry(key);
    return bytes ? LandmarksFromBytes(*bytes, fmt::format("key frame {}", key)) : Landmarks{};
  };
  return frames;
}

Calibration CalibrateGeometry(const Map& map, ThreadPool& pool, int max_images,
                              const ProgressSink& progress) {
  const MappedFrames all = FramesOf(map);
  const int images = std::min(max_images, map.size());
  const bool one_lap = map.description().laps.size() < 2;
  std::vector<double> squared(static_cast<std::size_t>(images), -1);
  constexpr int kAtATime = 16;
  for (int from = 0; from < images; from += kAtATime) {
    const int to = std::min(images, from + kAtATime);
    pool.For(to - from, 1, [&](std::int64_t chunk, std::int64_t) {
      const int i = from + static_cast<int>(chunk);
      const int key = static_cast<int>(static_cast<std::int64_t>(i) * map.size() / images);
      const KeyFrame truth = map.At(key);
      MappedFrames others = all;
      others.hidden.assign(all.world_from_camera.size(), 0);
      int nearest = -1;
      double least = 1e300;
      for (int k = 0; k < map.size(); ++k) {
        const bool hidden = one_lap ? k == key : map.At(k).lap == truth.lap;
        others.hidden[static_cast<std::size_t>(k)] = hidden ? 1 : 0;
        const double distance =
            (map.At(k).world_from_camera.translation() - truth.world_from_camera.translation())
                .norm();
        if (hidden || distance >= least) continue;
        nearest = k;
        least = distance;
      }
      if (nearest < 0) return;
      const auto found =
          VerifyPlaces(others, FindFeatures(ToGray(map.Image(key))), std::span(&nearest, 1));
      if (!found || !IsSure(*found)) return;
      const Vector6d xi = (found->world_from_camera.Inverse() * truth.world_from_camera).Log();
      squared[static_cast<std::size_t>(i)] = xi.dot(found->covariance.ldlt().solve(xi));
    });
    Report(progress, "calibrate", to, images);
  }
  std::erase_if(squared, [](double s) { return s < 0; });
  Calibration result{images, static_cast<int>(squared.size()), 0};
  if (result.sure < kFewest) return result;
  std::sort(squared.begin(), squared.end());
  double logs = 0;
  for (const auto& [share, chi2] : kChi2Of6) {
    const auto at = static_cast<std::size_t>(std::ceil(share * (result.sure + 1))) - 1;
    logs += std::log(squared[std::min(at, squared.size() - 1)] / chi2) / 2;
  }
  result.inflation = std::exp(logs / static_cast<double>(std::size(kChi2Of6)));
  return result;
}

Calibration CalibrateMap(const std::filesystem::path& file, ThreadPool& pool,
                         const ProgressSink& progress) {
  const Calibration calibration = CalibrateGeometry(Map::Open(file), pool, 300, progress);
  SetGeometryInflation(file, calibration.inflation);
  return calibration;
}

}  // namespace recollect::matching
