#pragma once

#include "recollect/core/progress.h"
#include "recollect/map/map.h"
#include "recollect/matching/build_landmarks.h"
#include "recollect/matching/verify.h"

namespace recollect::matching {

// What a map made with this keeps of its key frames.
GeometrySource LandmarkSource(const LandmarkOptions& options = {});

// A map's key frames for verification; `map` must outlive the result. Asking for the landmarks of
// a key frame throws Error where they are damaged; a key frame without any has none.
MappedFrames FramesOf(const Map& map);

struct Calibration {
  int images = 0, sure = 0;  // looked at, and found by geometry
  double inflation = 0;      // see MapDescription::geometry_inflation; 0: too few to tell
};

// Localises a map's own key frames by geometry, each without what its own lap gave to the map
// (without itself alone where there is one lap only), and measures by how much the errors of sure
// answers exceed their covariance: the 95 % ellipsoid, inflated, holds 95 % of them.
// max_images: evenly spread over the map.
Calibration CalibrateGeometry(const Map& map, ThreadPool& pool, int max_images = 300,
                              const ProgressSink& progress = {});

// Does that for the map in a file, and writes the result into it.
Calibration CalibrateMap(const std::filesystem::path& file, ThreadPool& pool,
                         const ProgressSink& progress = {});

}  // namespace recollect::matching
