#pragma once

#include <optional>
#include <string>
#include <vector>

#include "recollect/geometry/camera.h"
#include "recollect/geometry/se3.h"
#include "recollect/wnn/calibration.h"
#include "recollect/wnn/network.h"

namespace recollect {

// A lap that gave key frames to a map.
struct MapLap {
  std::string name;
  int key_frames = 0;
};

// What a map says of itself. The poses of its key frames, and so every answer found with it, are
// those of the left camera in the world of its laps, as their data set gave them.
struct MapDescription {
  StereoCamera camera;
  SE3 body_from_camera;                                // see Lap
  Eigen::Vector3d world_up = Eigen::Vector3d::Zero();  // zero: the data set does not say
  double spacing_m = 5;
  wnn::NetworkOptions network;
  // Standard deviations of poses found by geometry are so many times those of their model,
  // measured on the mapped laps themselves; 0 where that has not been done.
  double geometry_inflation = 0;
  // What votes are worth here, measured on the mapped laps themselves; none where that has not been
  // done since the last lap came.
  std::optional<wnn::Calibration> recognition;
  std::vector<MapLap> laps;

  int KeyFrames() const;
};

// As one JSON text and back. Parsing throws Error naming `where` on anything missing, unknown, of
// the wrong type or of a format version this program does not read.
std::string ToJson(const MapDescription& description);
MapDescription ParseMapDescription(const std::string& json, const std::string& where);

}  // namespace recollect
