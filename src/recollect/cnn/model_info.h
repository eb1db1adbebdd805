#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "recollect/cnn/covariance_calibration.h"
#include "recollect/cnn/crop.h"
#include "recollect/cnn/network_kind.h"
#include "recollect/geometry/camera.h"

namespace recollect::cnn {

// Errors over pairs: means, medians and what 95 % of them stay below, beside those of the guess
// "the live image was taken where the key frame was". Position in metres; heading is the angle
// between the optical axes, degrees.
struct PairFigures {
  std::int64_t pairs = 0;
  double position_mean_m = 0, position_median_m = 0;
  double heading_mean_deg = 0, heading_median_deg = 0;
  double no_motion_mean_m = 0, no_motion_median_m = 0;
  double no_motion_heading_mean_deg = 0;
  double position_p95_m = 0, heading_p95_deg = 0;
  // Of a network that predicts its covariance: the share of errors inside its 95 % ellipsoids, of
  // the pose (six dimensions) and of the position alone.
  std::optional<double> inside_95, position_inside_95;
};

// What a model file says of itself.
struct ModelInfo {
  NetworkKind network = NetworkKind::kCompact;
  Crop crop;
  PinholeCamera camera;  // of the crop, as in training
  std::uint64_t seed = 0;
  std::vector<std::string> laps;  // folders it was trained on
  std::int64_t training_pairs = 0;
  std::int64_t steps = 0;  // when the weights were taken, not when training ended
  double seconds = 0;
  std::int64_t parameters = 0;
  std::string validated_on;  // what pairs `validation` is about, in words
  PairFigures validation;
  // The network predicts its covariance. With this, 95 % of the errors on the pairs of `validation`
  // are inside their 95 % ellipsoids. None: it predicts none.
  std::optional<CovarianceCalibration> covariance;
  std::string options;  // the training's options, as JSON
};

// As JSON text and back; FromJson throws Error naming `where` for missing or wrong fields.
std::string ToJson(const ModelInfo& info);
std::string ToJson(const PairFigures& figures);
ModelInfo ModelInfoFromJson(const std::string& json, const std::string& where);

}  // namespace recollect::cnn
