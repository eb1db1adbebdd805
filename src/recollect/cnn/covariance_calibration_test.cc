#include "recollect/cnn/covariance_calibration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "recollect/core/error.h"

namespace recollect::cnn {
namespace {

constexpr double kBound = 12.592;  // 95 % of chi-square, six dimensions

// Errors that a network believes alike, and that are larger the worse their sightings agree.
struct Errors {
  explicit Errors(int count, double outliers = 0) {
    std::mt19937_64 random(7);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform;
    for (int i = 0; i < count; ++i) {
      agreements.emplace_back(-2 + normal(random), 0.3 * normal(random), 5 + normal(random));
      double square = 0;
      for (int k = 0; k < 6; ++k) square += std::pow(normal(random), 2);
      if (uniform(random) < outliers) square *= 100;
      squares.push_back(3 * square * std::exp(Weights().dot(agreements.back())));
    }
  }
  static Eigen::Vector3d Weights() { return {-0.8, 0, 0.4}; }

  // Of those whose first number of agreement is above or below the usual one.
  double Inside(const CovarianceCalibration& calibration, bool above) const {
    int inside = 0, all = 0;
    for (std::size_t i = 0; i < squares.size(); ++i) {
      if ((agreements[i].x() > calibration.usual.x()) != above) continue;
      ++all;
      inside += squares[i] <= kBound * calibration.FactorOf(agreements[i]);
    }
    return static_cast<double>(inside) / all;
  }

  std::vector<double> squares;
  std::vector<Eigen::Vector3d> agreements;
};

TEST(CovarianceCalibrationTest, FollowsHowWellSightingsAgree) {
  const Errors errors(4000);
  const auto found = Calibrate(errors.squares, errors.agreements, 0.95, kBound);
  EXPECT_LT((found.weights - Errors::Weights()).cwiseAbs().maxCoeff(), 0.1) << found.weights;
  EXPECT_NEAR(errors.Inside(found, true), 0.95, 0.01);
  EXPECT_NEAR(errors.Inside(found, false), 0.95, 0.01);
  CovarianceCalibration blind = found;
  blind.weights.setZero();
  EXPECT_GT(errors.Inside(blind, true) - errors.Inside(blind, false), 0.1);
}

TEST(CovarianceCalibrationTest, IsNotTornByPairsGoneWrong) {
  const Errors errors(4000, 0.03);
  const auto found = Calibrate(errors.squares, errors.agreements, 0.95, kBound);
  EXPECT_LT((found.weights - Errors::Weights()).cwiseAbs().maxCoeff(), 0.15) << found.weights;
}

TEST(CovarianceCalibrationTest, OfFewPairsIsAlmostTheScaleAlone) {
  const Errors errors(3);
  const auto found = Calibrate(errors.squares, errors.agreements, 0.95, kBound);
  std::vector<double> factors;
  for (const auto& agreement : errors.agreements) factors.push_back(found.FactorOf(agreement));
  const auto [least, greatest] = std::minmax_element(factors.begin(), factors.end());
  EXPECT_LT(*greatest / *least, 3);
  EXPECT_EQ(Calibrate({}, {}, 0.95, kBound), CovarianceCalibration());
  EXPECT_THROW(Calibrate(errors.squares, {}, 0.95, kBound), Error);
}

TEST(CovarianceCalibrationTest, NoAgreementTakesTheFactorAnywhere) {
  const CovarianceCalibration calibration{2, {0, 0, 0}, {1, 1, 1}};
  EXPECT_DOUBLE_EQ(calibration.FactorOf({0, 0, 0}), 2);
  EXPECT_NEAR(calibration.FactorOf({-13.8, 0, 0}), 2 * std::exp(-3), 1e-12);
  EXPECT_NEAR(calibration.FactorOf({0, 900, 0}), 2 * std::exp(3), 1e-12);
}

}  // namespace
}  // namespace recollect::cnn
