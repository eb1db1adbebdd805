#include "recollect/matching/refine.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "recollect/core/random.h"

namespace recollect::matching {
namespace {

const PinholeCamera kCamera{640, 480, 490, 500, 320, 240};

SE3 SomePose(Random& random, double scale = 1) {
  Vector6d xi;
  for (int i = 0; i < 6; ++i) xi[i] = scale * random.Normal();
  return SE3::Exp(xi);
}

// Points before a camera and where it sees them, with noise of their own standard deviations.
std::vector<Observation> Look(const SE3& pose, int count, double noise, Random& random) {
  std::vector<Observation> seen;
  while (static_cast<int>(seen.size()) < count) {
    const Eigen::Vector2d pixel(random.Uniform(0, 640), random.Uniform(0, 480));
    const Eigen::Vector3d p = kCamera.Unproject(pixel.x(), pixel.y(), random.Uniform(4, 40));
    Observation o;
    o.pixel_sigma = random.Uniform(0.5, 1.5);
    const double sigma = 0.05 * noise;
    o.covariance_world =
        sigma * sigma * Eigen::Matrix3d::Identity() + 1e-12 * Eigen::Matrix3d::Identity();
    o.p_world =
        pose * p + sigma * Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal());
    o.pixel = pixel + noise * o.pixel_sigma * Eigen::Vector2d(random.Normal(), random.Normal());
    seen.push_back(o);
  }
  return seen;
}

TEST(Residual, DerivativeIsThatOfNumericDifferences) {
  Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const SE3 pose = SomePose(random);
    const Observation o = Look(pose, 1, 1, random).front();
    Eigen::Matrix<double, 2, 6> jacobian;
    Residual(o, kCamera, pose, &jacobian);
    for (int i = 0; i < 6; ++i) {
      const Vector6d step = 1e-6 * Vector6d::Unit(i);
      const Eigen::Vector2d numeric = (Residual(o, kCamera, pose * SE3::Exp(step)) -
                                       Residual(o, kCamera, pose * SE3::Exp(-step))) /
                                      2e-6;
      EXPECT_LT((numeric - jacobian.col(i)).norm(), 1e-4 * (1 + numeric.norm()))
          << "trial " << trial << " parameter " << i << ": " << jacobian.col(i).transpose()
          << " instead of " << numeric.transpose();
    }
  }
}

TEST(RefinePose, FindsTheExactPose) {
  Random random(2);
  for (int trial = 0; trial < 20; ++trial) {
    const SE3 truth = SomePose(random);
    const auto seen = Look(truth, 12, 0, random);
    const auto found = RefinePose(seen, kCamera, truth * SomePose(random, 0.05));
    ASSERT_TRUE(found && found->converged);
    EXPECT_LT((found->world_from_camera.Inverse() * truth).Log().norm(), 1e-6);
  }
}

TEST(RefinePose, OutlivesGrossOutliers) {
  Random random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const SE3 truth = SomePose(random);
    auto seen = Look(truth, 60, 1, random);
    for (std::size_t i = 0; i < 24; ++i) {  // two in five are anywhere
      seen[i].pixel = {random.Uniform(0, 640), random.Uniform(0, 480)};
    }
    const auto found = RefinePose(seen, kCamera, truth * SomePose(random, 0.01));
    ASSERT_TRUE(found);
    EXPECT_LT((found->world_from_camera.translation() - truth.translation()).norm(), 0.1);
    // And they are known for what they are.
    int far = 0;
    for (std::size_t i = 0; i < 24; ++i) far += found->deviations[i] > 3 ? 1 : 0;
    EXPECT_GE(far, 20);
  }
}

// The mean of xi' C^-1 xi, 6 where C is the covariance of the errors. Cauchy's loss gives away a
// little, so the scale is made wide here. look(pose): what is seen from there.
template <typename Look>
double MeanSquaredDeviation(Random& random, const Look& look) {
  double sum = 0;
  constexpr int kTrials = 300;
  for (int trial = 0; trial < kTrials; ++trial) {
    const SE3 truth = SomePose(random);
    const auto found = RefinePose(look(truth), kCamera, truth, {.robust_scale = 50});
    if (!found) return -1;
    const Vector6d xi = (found->world_from_camera.Inverse() * truth).Log();
    sum += xi.dot(found->covariance.ldlt().solve(xi));
  }
  return sum / kTrials;
}

TEST(RefinePose, CovarianceIsThatOfTheErrors) {
  Random random(4);
  EXPECT_NEAR(
      MeanSquaredDeviation(random, [&](const SE3& pose) { return Look(pose, 40, 1, random); }), 6,
      0.6);
}

// Four landmarks each share the error of the one feature they are seen in, twice what it was told
// to be: neither must make the pose seem surer than it is.
TEST(RefinePose, CovarianceHoldsWhereFeaturesErrTogetherAndMoreThanWasTold) {
  Random random(7);
  const double mean = MeanSquaredDeviation(random, [&](const SE3& pose) {
    std::vector<Observation> seen;
    for (int feature = 0; feature < 60; ++feature) {
      const Eigen::Vector2d pixel(random.Uniform(0, 640), random.Uniform(0, 480));
      const Eigen::Vector2d error = 2 * Eigen::Vector2d(random.Normal(), random.Normal());
      for (int landmark = 0; landmark < 4; ++landmark) {
        const Eigen::Vector3d p = kCamera.Unproject(pixel.x(), pixel.y(), random.Uniform(4, 40));
        seen.push_back({pose * p, 1e-12 * Eigen::Matrix3d::Identity(), pixel + error, 1, feature});
      }
    }
    return seen;
  });
  EXPECT_GT(mean, 3);
  EXPECT_LT(mean, 12);  // the inverse Hessian alone makes it 96
}

// All landmarks of a key frame, or of a lap, are displaced alike, as by an error of its own pose or
// by the light of its day.
TEST(RefinePose, CovarianceHoldsWherePartsOfTheMapErrAsAWhole) {
  Random random(8);
  const auto mean = [&](int parts, int Observation::*told) {
    return MeanSquaredDeviation(random, [&](const SE3& pose) {
      std::vector<Observation> seen;
      for (int number = 0; number < parts; ++number) {
        const auto part = Look(pose, 400 / parts, 0.5, random);
        const Eigen::Vector3d error(random.Normal(), random.Normal(), random.Normal());
        for (Observation o : part) {
          o.p_world += 0.1 * error;
          if (told != nullptr) o.*told = number;
          seen.push_back(o);
        }
      }
      return seen;
    });
  };
  EXPECT_LT(mean(10, &Observation::key_frame), mean(10, nullptr) / 4);
  EXPECT_LT(mean(6, &Observation::lap), mean(6, nullptr) / 4);
}

TEST(RefinePose, RefusesWhatDoesNotFixAPose) {
  Random random(5);
  const SE3 truth = SomePose(random);
  auto seen = Look(truth, 40, 0, random);
  EXPECT_FALSE(RefinePose(std::span(seen).first(2), kCamera, truth));
  EXPECT_FALSE(RefinePose({}, kCamera, truth));
  // All matches are of one point.
  for (Observation& o : seen) o = seen.front();
  EXPECT_FALSE(RefinePose(seen, kCamera, truth));
  // All points are behind the camera.
  auto behind = Look(truth, 40, 0, random);
  for (Observation& o : behind) o.p_world = truth * -(truth.Inverse() * o.p_world);
  EXPECT_FALSE(RefinePose(behind, kCamera, truth));
}

TEST(RefinePose, WeighsAPriorByItsCovariance) {
  Random random(6);
  const SE3 truth = SomePose(random);
  const SE3 guess = truth * SE3::FromRotationVector({0, 0, 0}, {0.5, 0, 0});
  // Two points leave the pose open; a prior closes it, and stays where nothing is said against it.
  const auto seen = Look(truth, 2, 0, random);
  const auto held = RefinePose(seen, kCamera, guess, {}, PosePrior{guess, Matrix6d::Identity()});
  ASSERT_TRUE(held);
  EXPECT_LT(held->deviations[0], 1);
  // Forty points know better than a weak prior.
  const auto many = Look(truth, 40, 1, random);
  const auto found = RefinePose(many, kCamera, guess, {}, PosePrior{guess, Matrix6d::Identity()});
  ASSERT_TRUE(found);
  EXPECT_LT((found->world_from_camera.translation() - truth.translation()).norm(), 0.1);
  // A strong one is believed.
  const auto strong =
      RefinePose(many, kCamera, guess, {}, PosePrior{guess, 1e-10 * Matrix6d::Identity()});
  ASSERT_TRUE(strong);
  EXPECT_LT((strong->world_from_camera.translation() - guess.translation()).norm(), 0.01);
}

}  // namespace
}  // namespace recollect::matching
