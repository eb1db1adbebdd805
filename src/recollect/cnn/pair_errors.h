#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "recollect/cnn/model_info.h"
#include "recollect/cnn/pair_data.h"
#include "recollect/cnn/pose_network.h"

namespace recollect::cnn {

// Errors of a network pair by pair, in the order of the pairs given. Metres, degrees.
struct PairErrors {
  std::vector<double> position_m, heading_deg;
  std::vector<double> no_motion_m, no_motion_heading_deg;
  // Of a network that predicts its covariance, else empty: squared lengths of the errors of pose
  // (six dimensions) and position (three) in standard deviations.
  std::vector<double> pose_square, position_square;
  std::vector<Eigen::Vector3d> agreement;  // RelativeEstimate's

  // The error of one more pair, keyframe_from_live both.
  void Add(const SE3& predicted, const SE3& truth);

  // Of covariances that were not calibrated: with it 95 % of these errors of pose, and no fewer,
  // are inside their 95 % ellipsoids.
  CovarianceCalibration Calibration() const;

  // As if all covariances had been calibrated so.
  void Apply(const CovarianceCalibration& calibration);

  PairFigures Figures() const;
};

// Every pair of `data` numbered in `chosen`; all of them where that is empty.
PairErrors EvaluatePairs(const PoseNetwork& network, const PairData& data,
                         std::span<const std::size_t> chosen = {},
                         const ProgressSink& progress = {});

}  // namespace recollect::cnn
