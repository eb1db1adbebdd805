#include "recollect/cnn/motion_solver.h"

#include <gtest/gtest.h>

#include "recollect/cnn/gradient_check.h"
#include "recollect/cnn/layers.h"

namespace recollect::cnn {
namespace {

torch::Tensor Project(const torch::Tensor& motion, const torch::Tensor& points) {
  const torch::Tensor moved = Transform(motion, points);
  return moved.slice(1, 0, 2) / moved.slice(1, 2, 3);
}

class MotionSolverTest : public ::testing::Test {
 protected:
  MotionSolverTest() {
    torch::manual_seed(9);
    const torch::Tensor z = torch::rand({2, 1, 60}, torch::kDouble) * 20 + 8;
    const torch::Tensor places = torch::rand({2, 2, 60}, torch::kDouble) - 0.5;
    sightings_.points = torch::cat({places * z, z}, 1);
    delta_ = torch::tensor({0.02, -0.05, 0.01, 0.3, -0.1, 3.5, -0.01, 0.03, 0.0, -0.6, 0.1, -4.0},
                           torch::kDouble)
                 .view({2, 6});
    sightings_.seen = Project(Se3Layer(delta_), sightings_.points);
    sightings_.weight = torch::ones({2, 60}, torch::kDouble);
  }

  Sightings sightings_;
  torch::Tensor delta_;
  const SolverOptions no_prior_{.prior_rotation_sd = 1e3, .prior_translation_sd = 1e3};
};

TEST_F(MotionSolverTest, FindsTheMotion) {
  const torch::Tensor motion = SolveMotion(
      sightings_, {.iterations = 10, .prior_rotation_sd = 1e3, .prior_translation_sd = 1e3});
  EXPECT_TRUE(torch::allclose(motion, Se3Layer(delta_), 1e-5, 1e-6)) << motion;
}

TEST_F(MotionSolverTest, IsNotMisledByOutliers) {
  sightings_.seen.slice(2, 0, 15) += 0.5;  // a quarter of them, all the same way
  const torch::Tensor motion = SolveMotion(sightings_, {.iterations = 12});
  const torch::Tensor error = (motion - Se3Layer(delta_)).select(2, 3).norm(2, 1);
  EXPECT_LT(error.max().item<double>(), 0.2) << motion;
}

TEST_F(MotionSolverTest, WithoutGradientsAnswersTheSame) {
  Sightings single;
  single.points = sightings_.points.to(torch::kFloat);
  single.seen = sightings_.seen.to(torch::kFloat) + 0.01 * torch::randn({2, 2, 60});
  single.weight = torch::rand({2, 60});
  single.weight.select(1, 3).zero_();
  single.points[0][2][5] = -3;  // behind the camera
  const torch::Tensor expected = SolveMotion(single);
  const torch::NoGradGuard no_gradients;
  EXPECT_TRUE(torch::allclose(SolveMotion(single), expected, 1e-3, 1e-4))
      << SolveMotion(single) << expected;
}

TEST_F(MotionSolverTest, SaysNoMotionWhereNothingIsSeen) {
  sightings_.weight.zero_();
  const torch::Tensor still = torch::eye(3, 4, torch::kDouble).expand({2, 3, 4});
  EXPECT_TRUE(torch::allclose(SolveMotion(sightings_), still));
}

TEST_F(MotionSolverTest, StepsGradient) {
  sightings_.weight = torch::rand({2, 60}, torch::kDouble);
  const torch::Tensor from = Se3Layer(delta_ * 0.8);
  ExpectGradients(
      [&](const auto& in) {
        return SolverStep(from, {in[0], in[1], in[2]}, {});
      },
      {sightings_.points, sightings_.seen, sightings_.weight}, 1e-5);
}

// At the minimum the last step's gradient is that of the whole.
TEST_F(MotionSolverTest, GradientAtTheMinimum) {
  SolverOptions options = no_prior_;
  options.iterations = 12;
  options.outlier = 1e3;  // weights do not depend on the residuals
  ExpectGradients(
      [&](const auto& in) {
        return SolveMotion({sightings_.points, in[0], sightings_.weight}, options);
      },
      {sightings_.seen}, 1e-3);
}

TEST_F(MotionSolverTest, MovedGradient) {
  ExpectGradients([](const auto& in) { return Moved(in[0], in[1]); },
                  {Se3Layer(delta_), torch::randn({2, 6}, torch::kDouble) * 0.1});
}

// With noise of the deviation that a sighting is said to have, the solutions scatter as said: in
// the live camera's axes, which differ here from the key frame's.
TEST_F(MotionSolverTest, PrecisionIsThatOfTheSolutions) {
  constexpr std::int64_t kTrials = 400;
  const SolverOptions options{
      .outlier = 1e3, .prior_rotation_sd = 1e3, .prior_translation_sd = 1e3, .sighting_sd = 0.002};
  const torch::Tensor truth =
      Se3Layer(torch::tensor({{0.1, 0.5, -0.2, 0.5, -0.2, 1.0}}, torch::kDouble))
          .expand({kTrials, 3, 4});
  Sightings sightings;
  sightings.points = sightings_.points.slice(0, 0, 1).expand({kTrials, 3, 60});
  sightings.weight = torch::ones({kTrials, 60}, torch::kDouble);
  sightings.seen =
      Project(truth, sightings.points) + 0.002 * torch::randn({kTrials, 2, 60}, torch::kDouble);
  const torch::Tensor solved = SolveMotion(sightings, options);
  const torch::Tensor x = Se3Difference(solved, truth);
  const torch::Tensor precision = MotionPrecision(solved, sightings, options);
  const torch::Tensor covariance = torch::matmul(x.transpose(0, 1), x) / kTrials;
  const torch::Tensor share = torch::matmul(precision.mean(0), covariance);  // the identity
  EXPECT_NEAR(share.trace().item<double>() / 6, 1, 0.1);
  const torch::Tensor factor = torch::linalg_cholesky(precision).transpose(1, 2);
  const torch::Tensor z = torch::bmm(factor, x.unsqueeze(2)).squeeze(2);
  EXPECT_TRUE(torch::allclose(torch::matmul(z.transpose(0, 1), z) / kTrials,
                              torch::eye(6, torch::kDouble), 0, 0.25))
      << torch::matmul(z.transpose(0, 1), z) / kTrials;
}

}  // namespace
}  // namespace recollect::cnn
