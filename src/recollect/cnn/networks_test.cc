#include <gtest/gtest.h>

#include "recollect/cnn/compact_network.h"
#include "recollect/cnn/pair_network.h"
#include "recollect/core/error.h"

namespace recollect::cnn {
namespace {

const PinholeCamera kCamera{320, 192, 245, 245, 160, 96};

std::int64_t Parameters(const PairNetwork& network) {
  std::int64_t count = 0;
  for (const auto& parameter : network.parameters()) count += parameter.numel();
  return count;
}

torch::Tensor Still(std::int64_t batch) {
  return torch::eye(3, 4).unsqueeze(0).expand({batch, 3, 4});
}

class PaperNetworkTest : public ::testing::TestWithParam<std::pair<NetworkKind, std::int64_t>> {};

TEST_P(PaperNetworkTest, HasThePublishedSizeAndBeginsWithNoMotion) {
  const torch::InferenceMode inference;
  const auto [kind, parameters] = GetParam();
  const auto network = MakeNetwork(kind, kCamera);
  network->eval();
  EXPECT_EQ(Parameters(*network), parameters);
  const torch::Tensor live = torch::rand({2, 3, 240, 320}), key = torch::rand({2, 3, 240, 320});
  const Prediction prediction = network->forward(live, key);
  EXPECT_TRUE(torch::equal(prediction.motion, Still(2)));
}

// The sums of reference 78.7 M and 61.8 M: weights, biases and one slope a rectifier.
INSTANTIATE_TEST_SUITE_P(Variants, PaperNetworkTest,
                         ::testing::Values(std::pair{NetworkKind::kPaperA, 78725071},
                                           std::pair{NetworkKind::kPaperB, 61838287}));

TEST(CompactNetwork, IsSmallAndTakesWideImages) {
  const torch::InferenceMode inference;
  const auto network = MakeNetwork(NetworkKind::kCompact, {512, 128, 297, 297, 256, 64});
  network->eval();
  EXPECT_LE(Parameters(*network), 6000000);
  const torch::Tensor image = torch::randn({1, 3, 128, 512});
  const Prediction prediction = network->forward(image, image);
  EXPECT_EQ(prediction.motion.sizes(), (torch::IntArrayRef{1, 3, 4}));
  EXPECT_EQ(prediction.total.sizes(), (torch::IntArrayRef{1, 16 * 64}));
  EXPECT_EQ(prediction.log_depth.sizes(), (torch::IntArrayRef{1, 16 * 64}));
}

TEST(CompactNetwork, SeesNoMotionBetweenEqualImages) {
  const torch::InferenceMode inference;
  torch::manual_seed(1);
  const auto network = MakeNetwork(NetworkKind::kCompact, kCamera);
  network->eval();
  const torch::Tensor image = torch::randn({2, 3, 192, 320});
  const torch::Tensor motion = network->forward(image, image).motion;
  EXPECT_LT((motion - Still(2)).abs().max().item<double>(), 0.2);
}

TEST(CompactNetwork, EveryParameterLearns) {
  torch::manual_seed(2);
  const auto network = MakeNetwork(NetworkKind::kCompact, {96, 80, 80, 80, 48, 40}, true);
  const torch::Tensor live = torch::randn({1, 3, 80, 96}), key = torch::randn({1, 3, 80, 96});
  const Prediction prediction = network->forward(live, key);
  (prediction.motion.square().sum() + prediction.total.mean() + prediction.log_depth.mean() +
   prediction.whitening.sum())
      .backward();
  for (const auto& parameter : network->named_parameters()) {
    ASSERT_TRUE(parameter.value().grad().defined()) << parameter.key();
    EXPECT_TRUE(parameter.value().grad().isfinite().all().item<bool>()) << parameter.key();
  }
}

TEST(CompactNetwork, RefusesSidesThatDoNotDivide) {
  const auto network = MakeNetwork(NetworkKind::kCompact, kCamera);
  const torch::Tensor image = torch::zeros({1, 3, 100, 96});
  EXPECT_THROW(network->forward(image, image), Error);
}

TEST(NetworkKind, NamesRoundTrip) {
  for (const char* name : {"a", "b", "compact"}) {
    EXPECT_EQ(Name(NetworkKindFromName(name)), name);
  }
  EXPECT_THROW(NetworkKindFromName("c"), Error);
}

}  // namespace
}  // namespace recollect::cnn
