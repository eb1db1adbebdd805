#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "recollect/geometry/camera.h"
#include "recollect/geometry/se3.h"

namespace recollect::matching {

// A known point and where the live image shows it.
struct Observation {
  Eigen::Vector3d p_world;
  Eigen::Matrix3d covariance_world = Eigen::Matrix3d::Zero();  // of p_world, m^2
  Eigen::Vector2d pixel;
  double pixel_sigma = 1;  // of `pixel`
  // Of the live image, and of the map: observations of one err together; -1: each by itself.
  int feature = -1, key_frame = -1, lap = -1;
};

// What is known of the pose beforehand; its mean is world_from_camera, its covariance as in
// RefinedPose.
struct PosePrior {
  SE3 world_from_camera;
  Matrix6d covariance;
};

struct RefineOptions {
  int max_iterations = 15;
  double smallest_step = 0.01;  // in standard deviations of the pose; a shorter one is the last
  // Cauchy's scale, in standard deviations: residuals much beyond it are told to be wrong matches.
  double robust_scale = 2;
};

// The pose with covariance: the true one is world_from_camera * Exp(xi), xi ~ N(0, covariance),
// rotation first, so both parts are in the live camera's axes. rad, m.
struct RefinedPose {
  SE3 world_from_camera;
  Matrix6d covariance = Matrix6d::Zero();
  std::vector<double> deviations;  // of each observation: |residual| in its standard deviations
  bool converged = false;
};

// Residual of an observation, projection - pixel, and its derivative by xi of
// world_from_camera * Exp(xi).
Eigen::Vector2d Residual(const Observation& observation, const PinholeCamera& camera,
                         const SE3& world_from_camera,
                         Eigen::Matrix<double, 2, 6>* jacobian = nullptr);

// Maximum of the posterior by Gauss-Newton with iteratively reweighted residuals (Cauchy), from
// `start`. Each residual is weighed by its own covariance: that of the pixel and that of the point
// as a camera at `start` sees it. nullopt where the observations do not fix all six degrees of
// freedom or none lies before the camera.
//
// The covariance rests on how far the residuals really scatter, from feature to feature, from key
// frame to key frame and from lap to lap (the sandwich of Huber 1967, by clusters), rather than on
// how far they were told to: what errs together, or more or less than was thought, is counted as it
// is. The fewer features, the more it leans on the latter.
std::optional<RefinedPose> RefinePose(std::span<const Observation> observations,
                                      const PinholeCamera& camera, const SE3& start,
                                      const RefineOptions& options = {},
                                      const std::optional<PosePrior>& prior = {});

}  // namespace recollect::matching
