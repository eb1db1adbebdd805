#include "recollect/cnn/fused_errors.h"

#include <gtest/gtest.h>

#include "recollect/cnn/test_street.h"
#include "recollect/core/error.h"

namespace recollect::cnn {
namespace {

Matrix6d Covariance(double rotation, double translation) {
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal().head<3>().setConstant(rotation * rotation);
  covariance.diagonal().tail<3>().setConstant(translation * translation);
  return covariance;
}

SE3 Beside(const SE3& pose, double metres) {
  return pose * SE3(Eigen::Matrix3d::Identity(), {metres, 0, 0});
}

class FusionTest : public ::testing::Test {
 protected:
  double SidewaysError(const std::vector<PoseAnswer>& answers) const {
    return (truth_.Inverse() * FuseAnswers(answers)).translation().x();
  }
  const SE3 truth_ = SE3::FromRotationVector({0.1, 2, -0.3}, {10, -20, 3});
};

TEST_F(FusionTest, OneAnswerIsItself) {
  EXPECT_TRUE(FuseAnswers(std::vector<PoseAnswer>{{truth_, Covariance(0.01, 0.3)}})
                  .Matrix()
                  .isApprox(truth_.Matrix(), 1e-12));
}

TEST_F(FusionTest, WeighsByCovariance) {
  // Small against their deviations, so that nothing is contradicted: the weighted mean.
  const double mean = SidewaysError({{Beside(truth_, 0.001), Covariance(0.01, 0.1)},
                                     {Beside(truth_, -0.004), Covariance(0.01, 0.2)}});
  EXPECT_NEAR(mean, (0.001 * 4 - 0.004) / 5, 1e-6);
}

TEST_F(FusionTest, IsNotDrawnByAnAnswerThatIsContradicted) {
  const Matrix6d covariance = Covariance(0.01, 0.1);
  const double fused = SidewaysError({{Beside(truth_, 4), covariance},
                                      {Beside(truth_, 0.05), covariance},
                                      {Beside(truth_, -0.05), covariance}});
  EXPECT_LT(std::abs(fused), 0.05);
}

TEST(EvaluateNearestTest, CountsTheSameLiveFramesForAll) {
  const TestStreet street({{.length_m = 10}, {.length_m = 10, .lateral_m = 0.5, .seed = 2}});
  ThreadPool pool(1);
  const PoseNetwork network = PoseNetwork::Untrained(320, 240);
  const PairData data = LoadPairs(std::span(street.laps()).last(1),
                                  std::span(street.laps()).first(1), network.crop(), {}, pool);
  const std::vector<PairErrors> errors = EvaluateNearest(network, data, 3);
  ASSERT_EQ(errors.size(), 3U);
  for (const PairErrors& of : errors) {
    EXPECT_EQ(of.position_m.size(), errors[0].position_m.size());
    EXPECT_EQ(of.no_motion_m, errors[0].no_motion_m);
  }
  // From one key frame the untrained network's answer is that key frame's pose.
  EXPECT_NEAR(errors[0].Figures().position_mean_m, errors[0].Figures().no_motion_mean_m, 1e-6);
  // Two together say something else.
  EXPECT_NE(errors[1].position_m, errors[0].position_m);
  EXPECT_THROW(EvaluateNearest(network, data, 1000), Error);
}

}  // namespace
}  // namespace recollect::cnn
