#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace recollect::cnn {

// What makes a predicted covariance true on a day that was not trained on: a factor for all pairs,
// and one that follows how well a pair's sightings agree (MotionFit). Errors of pairs trained on
// are small however badly another day's would agree, so only other pairs can tell what that means.
struct CovarianceCalibration {
  double scale = 1;
  Eigen::Vector3d usual = Eigen::Vector3d::Zero();    // agreement
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();  // of the agreement's difference to that

  // What the covariance of a pair is to be multiplied by.
  double FactorOf(const Eigen::Vector3d& agreement) const;

  bool operator==(const CovarianceCalibration&) const = default;
};

// From pairs that were not trained on: their errors' squared lengths in standard deviations as they
// were predicted, six dimensions, and how well their sightings agreed. The weights are the
// likeliest under a t distribution of 4 degrees of freedom, as in training, drawn to none; the
// scale puts `share` of the errors, and no fewer, within `bound`. No pairs: none of it.
CovarianceCalibration Calibrate(std::span<const double> squares,
                                std::span<const Eigen::Vector3d> agreements, double share,
                                double bound);

}  // namespace recollect::cnn
