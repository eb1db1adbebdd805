#include "recollect/cnn/covariance_head.h"

#include <gtest/gtest.h>

#include "recollect/cnn/layers.h"
#include "recollect/cnn/loss.h"

namespace recollect::cnn {
namespace {

constexpr std::int64_t kFeatures = 8, kCells = 30;

// What least squares was given for so many pairs; it found the truth, "no motion".
Sightings Seen(std::int64_t pairs) {
  Sightings sightings;
  const torch::Tensor z = torch::rand({pairs, 1, kCells}) * 20 + 8;
  const torch::Tensor places = torch::rand({pairs, 2, kCells}) - 0.5;
  sightings.points = torch::cat({places * z, z}, 1);
  sightings.seen = places;
  sightings.weight = torch::rand({pairs, kCells});
  return sightings;
}

torch::Tensor Still(std::int64_t pairs) { return torch::eye(3, 4).expand({pairs, 3, 4}); }

// Errors whose size along three axes depends on the features, over a factor of about 20 between
// pairs, and two of which go together.
torch::Tensor Errors(const torch::Tensor& features) {
  const std::int64_t pairs = features.size(0);
  const torch::Tensor unit = torch::tensor({0.005F, 0.005F, 0.005F, 0.1F, 0.1F, 0.1F});
  torch::Tensor x = torch::randn({pairs, 6}) * unit;
  x.select(1, 1) += x.select(1, 3) * 0.1;  // turning and going sideways look alike
  x.select(1, 5) *= (0.75 * features.select(1, 0)).exp();
  return x;
}

struct Sample {
  explicit Sample(std::int64_t pairs)
      : features(torch::randn({pairs, kFeatures})), sightings(Seen(pairs)), still(Still(pairs)) {
    const torch::Tensor x = Errors(features);
    truth = Se3Layer(x);
  }
  torch::Tensor features;
  Sightings sightings;
  torch::Tensor still, truth;
};

torch::Tensor Forward(CovarianceHead& head, const Sample& sample) {
  return head.forward(sample.features, sample.still, sample.sightings,
                      MotionFit(sample.still, sample.sightings).detach());
}

// Squared lengths of the errors in the deviations predicted, [pairs].
torch::Tensor Squares(CovarianceHead& head, const Sample& sample) {
  const torch::NoGradGuard no_gradients;
  const torch::Tensor whitening = Forward(head, sample);
  const torch::Tensor x = Se3Difference(sample.still, sample.truth).unsqueeze(2);
  return torch::bmm(whitening, x).square().sum({1, 2});
}

double Loss(CovarianceHead& head, const Sample& sample) {
  const torch::NoGradGuard no_gradients;
  return LikelihoodLoss(sample.still, sample.truth, Forward(head, sample)).item<double>();
}

TEST(CovarianceHeadTest, LearnsNoiseThatDependsOnThePair) {
  torch::manual_seed(4);
  CovarianceHead head(kFeatures);
  torch::optim::Adam adam(head.parameters(), torch::optim::AdamOptions(5e-3));
  for (int step = 0; step < 500; ++step) {
    const Sample sample(128);
    adam.zero_grad();
    LikelihoodLoss(sample.still, sample.truth, Forward(head, sample)).backward();
    adam.step();
  }
  const Sample test(4000);
  const torch::Tensor squares = Squares(head, test);
  // One factor for all, as calibration finds it, and the noisy half and the quiet half both have
  // their 95 %. With one covariance for all pairs it would be some 99 and 91 %.
  const double bound = std::get<0>(squares.kthvalue(3800)).item<double>();
  const torch::Tensor noisy = test.features.select(1, 0) > 0;
  const torch::Tensor inside = (squares <= bound).to(torch::kFloat);
  EXPECT_NEAR(inside.masked_select(noisy).mean().item<double>(), 0.95, 0.015);
  EXPECT_NEAR(inside.masked_select(noisy.logical_not()).mean().item<double>(), 0.95, 0.015);
  // And as they are normal, their squares are those of six dimensions.
  EXPECT_NEAR(squares.median().item<double>() / bound, 5.348 / 12.592, 0.03);

  // The correlation between turning and going sideways was found: without it the likelihood falls.
  const torch::NoGradGuard no_gradients;
  const torch::Tensor whitening = Forward(head, test);
  const torch::Tensor covariance = torch::inverse(torch::bmm(whitening.transpose(1, 2), whitening));
  const torch::Tensor plain =
      covariance.diagonal(0, 1, 2).rsqrt().diag_embed();  // the same deviations, uncorrelated
  EXPECT_LT(Loss(head, test) + 0.3, LikelihoodLoss(test.still, test.truth, plain).item<double>());
}

TEST(CovarianceHeadTest, NothingFlowsBackIntoItsInputs) {
  torch::manual_seed(4);
  CovarianceHead head(kFeatures);
  Sample sample(3);
  for (torch::Tensor* input : {&sample.features, &sample.sightings.points, &sample.sightings.seen,
                               &sample.sightings.weight, &sample.still}) {
    *input = input->clone().requires_grad_(true);
  }
  Forward(head, sample).sum().backward();
  for (const torch::Tensor& input : {sample.features, sample.sightings.points, sample.still}) {
    EXPECT_FALSE(input.grad().defined());
  }
  for (const torch::Tensor& parameter : head.parameters()) {
    EXPECT_TRUE(parameter.grad().defined());
  }
}

// Where nothing is seen, and where everything fits without end, the factor stays one.
TEST(CovarianceHeadTest, ExtremesStayFinite) {
  torch::manual_seed(4);
  CovarianceHead head(kFeatures);
  for (auto& parameter : head.parameters()) {
    const torch::NoGradGuard no_gradients;
    parameter.add_(torch::randn_like(parameter));
  }
  Sample sample(2);
  sample.sightings.weight[0] *= 0;
  sample.sightings.weight[1] *= 1e12;
  sample.features *= 1e6;
  const torch::Tensor whitening = Forward(head, sample);
  EXPECT_TRUE(whitening.isfinite().all().item<bool>());
  EXPECT_TRUE((whitening.diagonal(0, 1, 2) > 0).all().item<bool>());
  EXPECT_TRUE(torch::equal(whitening, whitening.triu()));
}

}  // namespace
}  // namespace recollect::cnn
