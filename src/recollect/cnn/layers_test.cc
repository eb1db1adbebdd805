#include "recollect/cnn/layers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "recollect/cnn/gradient_check.h"
#include "recollect/cnn/loss.h"

namespace recollect::cnn {
namespace {

torch::Tensor Doubles(std::vector<double> values) {
  return torch::tensor(values, torch::kDouble).view({1, -1});
}

// Rotation vectors around all the places where the formula changes its form.
std::vector<torch::Tensor> HardDeltas() {
  const double pi = std::numbers::pi;
  std::vector<torch::Tensor> deltas;
  for (const double angle : {0.0, 1e-8, 1e-3, 0.0999, 0.1001, 1.0, pi - 1e-3, pi - 1e-7, pi, 4.0}) {
    const double x = angle * 2 / 3, y = -angle / 3, z = angle * 2 / 3;
    deltas.push_back(Doubles({x, y, z, 1, -2, 3}));
  }
  return deltas;
}

TEST(Se3Layer, AgreesWithSe3) {
  for (const torch::Tensor& delta : HardDeltas()) {
    const auto* d = delta.data_ptr<double>();
    const Eigen::Matrix4d expected =
        SE3::FromRotationVector({d[0], d[1], d[2]}, {d[3], d[4], d[5]}).Matrix();
    const torch::Tensor motion = Se3Layer(delta);
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) {
        EXPECT_NEAR(motion[0][row][column].item<double>(), expected(row, column), 1e-9) << delta;
      }
    }
  }
}

TEST(Se3Layer, GradientAtZeroSmallAndNearPi) {
  for (const torch::Tensor& delta : HardDeltas()) {
    SCOPED_TRACE(delta);
    ExpectGradients([](const auto& in) { return Se3Layer(in[0]); }, {delta});
  }
}

TEST(Se3Layer, DeltaRoundTrip) {
  const SE3 motion = SE3::FromRotationVector({0.3, -0.2, 0.1}, {1, 2, 3});
  const SE3 back = MotionFromDelta(DeltaFromMotion(motion));
  EXPECT_TRUE(back.Matrix().isApprox(motion.Matrix(), 1e-12));
}

torch::Tensor MotionOf(const SE3& motion) {
  torch::Tensor out = torch::empty({1, 3, 4}, torch::kDouble);
  Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(out.data_ptr<double>()) =
      motion.Matrix().topRows<3>();
  return out;
}

TEST(Se3Log, AgreesWithSe3) {
  for (const double angle : {0.0, 1e-8, 1e-3, 0.0999, 0.1001, 1.0, 2.0, 3.0}) {
    Vector6d x;
    x << angle * 2 / 3, -angle / 3, angle * 2 / 3, 1, -2, 3;
    const torch::Tensor log = Se3Log(MotionOf(SE3::Exp(x)));
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(log[0][i].item<double>(), x[i], 1e-9) << angle;
  }
}

TEST(Se3Log, Gradient) {
  for (const double angle : {0.0, 0.05, 0.5, 2.0}) {
    SCOPED_TRACE(angle);
    const torch::Tensor delta = Doubles({angle * 2 / 3, -angle / 3, angle * 2 / 3, 1, -2, 3});
    ExpectGradients([](const auto& in) { return Se3Log(Se3Layer(in[0])); }, {delta});
  }
}

TEST(Se3Log, DifferenceLeadsFromOneToTheOther) {
  Vector6d x;
  x << 0.02, -0.01, 0.03, 0.2, 0.1, -0.3;
  const SE3 a = SE3::FromRotationVector({0.3, -0.2, 0.1}, {1, 2, 3});
  const torch::Tensor between = Se3Difference(MotionOf(a), MotionOf(a * SE3::Exp(x)));
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(between[0][i].item<double>(), x[i], 1e-12);
}

TEST(Grid3d, IsDepthTimesRay) {
  const PinholeCamera camera{4, 3, 200, 210, 1.5, 1.25};
  const torch::Tensor depth = torch::rand({2, 3, 4}) + 1;
  const torch::Tensor points = Grid3d(depth, RayGrid(camera));
  ASSERT_EQ(points.sizes(), (torch::IntArrayRef{2, 3, 12}));
  for (int v = 0; v < 3; ++v) {
    for (int u = 0; u < 4; ++u) {
      const Eigen::Vector3d expected = camera.Unproject(u, v, depth[1][v][u].item<double>());
      for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(points[1][i][4 * v + u].item<double>(), expected[i], 1e-5);
      }
    }
  }
}

TEST(Grid3d, Gradient) {
  const torch::Tensor depth = torch::rand({2, 3, 4}, torch::kDouble) + 1;
  const torch::Tensor rays = torch::randn({3, 3, 4}, torch::kDouble);
  ExpectGradients([](const auto& in) { return Grid3d(in[0], in[1]); }, {depth, rays});
}

TEST(Transform, Gradient) {
  ExpectGradients(
      [](const auto& in) { return Transform(in[0], in[1]); },
      {torch::randn({2, 3, 4}, torch::kDouble), torch::randn({2, 3, 5}, torch::kDouble)});
}

class ProjectionLossTest : public ::testing::Test {
 protected:
  const torch::Tensor truth_ = Se3Layer(torch::randn({2, 6}, torch::kDouble) * 0.3);
  const torch::Tensor points_ =
      torch::randn({2, 3, 7}, torch::kDouble) + torch::tensor({0., 0., 20.}).view({1, 3, 1});
  torch::Tensor valid_ = torch::ones({2, 7}, torch::kBool);
};

TEST_F(ProjectionLossTest, IsTheMeanDistanceOfTheValidPoints) {
  valid_[0][2] = false;
  valid_[1] = false;
  const torch::Tensor predicted = Se3Layer(torch::randn({2, 6}, torch::kDouble) * 0.3);
  double sum = 0;
  for (int i = 0; i < 7; ++i) {
    if (i == 2) continue;
    const torch::Tensor p = points_[0].slice(1, i, i + 1);
    const auto at = [&](const torch::Tensor& motion) {
      return torch::mm(motion[0].slice(1, 0, 3), p) + motion[0].slice(1, 3, 4);
    };
    sum += (at(predicted) - at(truth_)).norm().item<double>();
  }
  EXPECT_NEAR(ProjectionLoss(predicted, truth_, points_, valid_).item<double>(), sum / 6, 1e-6);
}

TEST_F(ProjectionLossTest, IsZeroAtTheTruthAndWithoutValidPoints) {
  EXPECT_NEAR(ProjectionLoss(truth_, truth_, points_, valid_).item<double>(), 0, 2e-5);
  const torch::Tensor none = torch::zeros_like(valid_);
  EXPECT_EQ(ProjectionLoss(truth_ + 1, truth_, points_, none).item<double>(), 0);
}

TEST_F(ProjectionLossTest, ABoundOnTheDepthBoundsTheRotationsShare) {
  torch::Tensor turn = torch::zeros({2, 6}, torch::kDouble);
  turn.select(1, 1).fill_(0.1);
  const torch::Tensor still = Se3Layer(torch::zeros({2, 6}, torch::kDouble));
  const double free = ProjectionLoss(Se3Layer(turn), still, points_, valid_).item<double>();
  const double half = ProjectionLoss(Se3Layer(turn), still, points_, valid_, 10).item<double>();
  EXPECT_GT(free, 1.5 * half);
  EXPECT_NEAR(half, 10 * 2 * std::sin(0.05), 0.05);
}

TEST_F(ProjectionLossTest, GradientThroughSe3) {
  valid_[1][3] = false;
  for (const double far : {0.0, 15.0}) {
    ExpectGradients(
        [&](const auto& in) {
          return ProjectionLoss(Se3Layer(in[0]), truth_, points_, valid_, far);
        },
        {torch::randn({2, 6}, torch::kDouble) * 0.2});
  }
}

// At the truth itself the norm's kink is rounded off: the gradient is zero, not NaN.
TEST_F(ProjectionLossTest, GradientIsFiniteAtTheTruth) {
  torch::Tensor delta = torch::zeros({2, 6}, torch::kDouble).requires_grad_(true);
  ProjectionLoss(Se3Layer(delta), Se3Layer(torch::zeros({2, 6}, torch::kDouble)), points_, valid_)
      .backward();
  EXPECT_TRUE(delta.grad().isfinite().all().item<bool>());
}

TEST_F(ProjectionLossTest, ReprojectionIsThePixelsBetweenTheProjections) {
  torch::Tensor delta = torch::zeros({2, 6}, torch::kDouble);
  const torch::Tensor still = Se3Layer(delta);
  const torch::Tensor ahead = torch::tensor({{1.0, 2.0}, {0.5, 0.0}, {10.0, 0.1}}, torch::kDouble)
                                  .unsqueeze(0)
                                  .repeat({2, 1, 1});  // the second point is too near to count
  delta.select(1, 3).fill_(0.2);
  const torch::Tensor valid = torch::ones({2, 2}, torch::kBool);
  EXPECT_NEAR(ReprojectionLoss(Se3Layer(delta), still, ahead, valid, 200, 300).item<double>(),
              200 * 0.2 / 10, 1e-4);
}

TEST_F(ProjectionLossTest, ReprojectionGradientThroughSe3) {
  const torch::Tensor ahead =
      torch::cat({points_.slice(1, 0, 2), points_.slice(1, 2, 3).abs() + 6}, 1);
  ExpectGradients(
      [&](const auto& in) {
        return ReprojectionLoss(Se3Layer(in[0]), truth_, ahead, valid_, 200, 300);
      },
      {torch::randn({2, 6}, torch::kDouble) * 0.1});
}

TEST(PoseLosses, DistanceIsMetresAndRadians) {
  const torch::Tensor delta = torch::tensor({{0.0, 0.02, 0.0, 3.0, 0.0, 4.0}}, torch::kDouble);
  const MotionDistance d =
      DistanceBetween(Se3Layer(delta), Se3Layer(torch::zeros({1, 6}, torch::kDouble)));
  EXPECT_NEAR(d.translation.item<double>(), 5, 1e-6);
  EXPECT_NEAR(d.rotation.item<double>(), 0.02, 1e-4);
}

TEST(PoseLosses, Gradients) {
  torch::manual_seed(11);
  const torch::Tensor truth = Se3Layer(torch::randn({3, 6}, torch::kDouble) * 0.3);
  const torch::Tensor delta = torch::randn({3, 6}, torch::kDouble) * 0.3;
  ExpectGradients([&](const auto& in) { return WeightedPoseLoss(Se3Layer(in[0]), truth, 7.0); },
                  {delta});
  ExpectGradients([&](const auto& in) { return HomoscedasticLoss(Se3Layer(in[0]), truth, in[1]); },
                  {delta, torch::tensor({0.3, -2.0}, torch::kDouble)});
}

class LikelihoodTest : public ::testing::Test {
 protected:
  torch::Tensor Whitening(std::int64_t batch) const {
    return torch::randn({batch, 6, 6}, torch::kDouble).triu(1) +
           torch::diag_embed(torch::rand({batch, 6}, torch::kDouble) + 0.5);
  }
  const torch::Tensor truth_ = Se3Layer(torch::randn({3, 6}, torch::kDouble) * 0.2);
};

TEST_F(LikelihoodTest, Gradient) {
  ExpectGradients([&](const auto& in) { return LikelihoodLoss(Se3Layer(in[0]), truth_, in[1]); },
                  {torch::randn({3, 6}, torch::kDouble) * 0.2, Whitening(3)});
}

// Errors drawn with a known covariance are likeliest under that one: no more, no less, not turned.
TEST_F(LikelihoodTest, IsLeastAtTheTrueCovariance) {
  torch::manual_seed(3);
  constexpr std::int64_t kPairs = 20000;
  const torch::Tensor whitening = Whitening(1);
  // Of a t distribution as the loss has it: normal over the root of chi-square / 4.
  const torch::Tensor z = torch::randn({kPairs, 6}, torch::kDouble);
  const torch::Tensor chi = torch::randn({kPairs, 4}, torch::kDouble).square().sum(1, true);
  const torch::Tensor x =
      1e-3 * torch::matmul(z / (chi / 4).sqrt(), torch::inverse(whitening[0]).transpose(0, 1));
  const torch::Tensor still = Se3Layer(torch::zeros({kPairs, 6}, torch::kDouble));
  const auto loss = [&](const torch::Tensor& w) {
    return LikelihoodLoss(still, Se3Layer(x), w.expand({kPairs, 6, 6})).item<double>();
  };
  const torch::Tensor right = 1e3 * whitening;
  EXPECT_LT(loss(right), loss(1.1 * right));
  EXPECT_LT(loss(right), loss(0.9 * right));
  EXPECT_LT(loss(right), loss(right.diagonal(0, 1, 2).diag_embed()));
}

TEST_F(LikelihoodTest, OnePairGoneWrongIsBounded) {
  const auto pull = [](double metres) {  // on the logarithm of the whitening
    torch::Tensor log_whitening = torch::zeros({1}, torch::kDouble).requires_grad_(true);
    const torch::Tensor delta = Doubles({0, 0, 0, 0, 0, metres});
    LikelihoodLoss(Se3Layer(delta), Se3Layer(torch::zeros_like(delta)),
                   log_whitening.exp() * torch::eye(6, torch::kDouble).unsqueeze(0))
        .backward();
    return log_whitening.grad().item<double>();
  };
  EXPECT_LT(pull(100), 10);
  EXPECT_NEAR(pull(1000), pull(100), 0.01);
}

}  // namespace
}  // namespace recollect::cnn
