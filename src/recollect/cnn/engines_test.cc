#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "recollect/cnn/compact_network.h"
#include "recollect/cnn/convolution_taps.h"
#include "recollect/cnn/fixed_product.h"
#include "recollect/cnn/pair_network.h"
#include "recollect/cnn/paper_network.h"
#include "recollect/cnn/pose_network.h"

namespace recollect::cnn {
namespace {

// A network whose answers are of the size of a trained one's: metres and tenths of a radian.
std::shared_ptr<PaperNetwork> Lively(NetworkKind kind) {
  torch::manual_seed(3);
  auto network = std::make_shared<PaperNetwork>(kind);
  const torch::NoGradGuard no_gradients;
  for (auto& parameter : network->named_parameters()) {
    torch::Tensor value = parameter.value();
    if (value.dim() == 1 && value.numel() > 1) value.normal_(0, 0.05);
    if (value.dim() == 4 && value.size(0) == 6) value.normal_(0, 0.3 / std::sqrt(value[0].numel()));
  }
  network->eval();
  return network;
}

class PaperEngineTest : public ::testing::TestWithParam<NetworkKind> {};

TEST_P(PaperEngineTest, AnswersAsLibtorchDoes) {
  const torch::InferenceMode inference;
  const auto network = Lively(GetParam());
  const torch::Tensor images = torch::rand({6, 3, 240, 320});
  // One live image against several key frames, and the other way round.
  const std::vector<ImagePair> pairs = {{0, 1}, {0, 2}, {0, 3}, {4, 5}, {5, 4}};
  std::vector<torch::Tensor> live, key;
  for (const ImagePair& pair : pairs) {
    live.push_back(images[pair.live]);
    key.push_back(images[pair.key]);
  }
  const torch::Tensor expected =
      network->ForwardPlain(torch::stack(live), torch::stack(key)).motion;
  ASSERT_GT((expected - torch::eye(3, 4)).abs().max().item<double>(), 0.03);

  const auto engine = network->MakeEngine(240, 320, Precision::kFloat32);
  EXPECT_LT((engine->Answer(images, pairs).motion - expected).abs().max().item<double>(), 1e-4);
  const torch::Tensor one = engine->Answer(images, std::span(pairs).last(1)).motion;
  EXPECT_LT((one[0] - expected[4]).abs().max().item<double>(), 1e-4);

  const auto half = network->MakeEngine(240, 320, Precision::kBfloat16);
  EXPECT_LT((half->Answer(images, pairs).motion - expected).abs().max().item<double>(), 0.03);
}

INSTANTIATE_TEST_SUITE_P(Variants, PaperEngineTest,
                         ::testing::Values(NetworkKind::kPaperA, NetworkKind::kPaperB));

TEST(FixedProduct, IsTheProductOnAllTails) {
  torch::manual_seed(5);
  for (const std::int64_t inputs : {1, 16, 37, 160}) {
    for (const std::int64_t outputs : {1, 4, 70}) {
      for (const std::int64_t rows : {1, 3, 4, 9}) {
        const torch::Tensor weight = torch::randn({outputs, inputs}), bias = torch::randn(outputs);
        const torch::Tensor source = torch::randn({rows, inputs});
        const torch::Tensor got = FixedProduct(weight, bias, 0.25F).Run(source);
        const torch::Tensor sum = torch::addmm(bias, source, weight.t());
        const torch::Tensor expected = torch::where(sum > 0, sum, 0.25 * sum);
        EXPECT_LT((got - expected).abs().max().item<double>(), 2e-4 * std::sqrt(inputs))
            << inputs << " " << outputs << " " << rows;
      }
    }
  }
}

// The output layer starts at zero; here all layers have a say.
std::shared_ptr<CompactNetwork> LivelyCompact(bool covariance) {
  torch::manual_seed(4);
  const PinholeCamera camera{320, 240, 250, 260, 158, 121};
  auto network = std::make_shared<CompactNetwork>(camera, covariance);
  const torch::NoGradGuard no_gradients;
  for (auto& parameter : network->named_parameters()) {
    torch::Tensor value = parameter.value();
    if (value.dim() == 1 && value.numel() > 1) value.normal_(0.5, 0.3);
    if (value.abs().max().item<double>() == 0) value.normal_(0, 0.1);
  }
  network->eval();
  return network;
}

TEST(CompactEngine, AnswersAsLibtorchDoes) {
  const torch::InferenceMode inference;
  const auto network = LivelyCompact(true);
  // Moved a little from one to the next, so that there is something to be seen again.
  const torch::Tensor scene = torch::nn::functional::interpolate(
      torch::randn({1, 3, 40, 60}),
      torch::nn::functional::InterpolateFuncOptions().size(std::vector<std::int64_t>{280, 400}));
  std::vector<torch::Tensor> views;
  for (std::int64_t i = 0; i < 4; ++i) {
    views.push_back(scene[0].slice(1, 5 * i, 5 * i + 240).slice(2, 9 * i, 9 * i + 320));
  }
  const torch::Tensor images = torch::stack(views);
  const std::vector<ImagePair> pairs = {{0, 1}, {0, 2}, {3, 1}};
  std::vector<torch::Tensor> live, key;
  for (const ImagePair& pair : pairs) {
    live.push_back(images[pair.live]);
    key.push_back(images[pair.key]);
  }
  const Prediction expected = network->forward(torch::stack(live), torch::stack(key));
  ASSERT_GT((expected.motion - torch::eye(3, 4)).abs().max().item<double>(), 0.03);
  const auto engine = network->MakeEngine(240, 320, Precision::kFloat32);
  const PairAnswers answers = engine->Answer(images, pairs);
  EXPECT_LT((answers.motion - expected.motion).abs().max().item<double>(), 5e-4);
  EXPECT_LT((answers.whitening - expected.whitening).abs().max().item<double>(),
            5e-4 * expected.whitening.abs().max().item<double>());
  const PairAnswers one = engine->Answer(images, std::span(pairs).last(1));
  EXPECT_LT((one.motion[0] - expected.motion[2]).abs().max().item<double>(), 5e-4);

  const auto half = network->MakeEngine(240, 320, Precision::kBfloat16);
  EXPECT_LT((half->Answer(images, pairs).motion - expected.motion).abs().max().item<double>(), 0.1);
  const auto plain = LivelyCompact(false)->MakeEngine(240, 320, Precision::kFloat32);
  EXPECT_FALSE(plain->Answer(images, pairs).whitening.defined());
}

TEST(ConvolutionTapsOf, LeavesOutWhatMeetsPaddingOnly) {
  // 3 x 3 over 2 x 3 cells with stride 2: the kernel's upper row is always outside.
  const ConvolutionTaps wide = ConvolutionTaps::Of(2, 3, 3, 3, 2, 1);
  EXPECT_EQ(wide.rows, 1);
  EXPECT_EQ(wide.columns, 2);
  EXPECT_EQ(wide.first_tap, 3);
  EXPECT_EQ(wide.taps, 6);
  EXPECT_EQ(wide.sources, (std::vector<std::int64_t>{6, 0, 1, 6, 3, 4, 1, 2, 6, 4, 5, 6}));
  // 1 x 2 over 1 x 2 cells with padding 1: the upper and the lower outputs see nothing.
  const ConvolutionTaps grown = ConvolutionTaps::Of(1, 2, 1, 2, 1, 1);
  EXPECT_EQ(grown.outputs, (std::vector<std::int64_t>{3, 4, 5}));
  EXPECT_EQ(grown.sources, (std::vector<std::int64_t>{2, 0, 0, 1, 1, 2}));
}

TEST(PoseNetworkEngine, OneLiveImageAgainstSeveralKeyFrames) {
  ModelInfo info;
  info.network = NetworkKind::kPaperB;
  info.crop = DefaultCrop(info.network, 320, 240);
  const PoseNetwork network(info, Lively(info.network));
  std::vector<cv::Mat> images;
  for (int i = 0; i < 3; ++i) {
    images.emplace_back(240, 320, CV_8UC3);
    cv::randu(images.back(), 0, 255);
  }
  const std::vector<CropPair> pairs = {{images[0], images[1]}, {images[0], images[2]}};
  const std::vector<SE3> together = network.KeyframeFromLive(pairs);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const SE3 alone = network.KeyframeFromLive(pairs[i].live.clone(), pairs[i].key.clone());
    EXPECT_TRUE(together[i].Matrix().isApprox(alone.Matrix(), 1e-4));
  }
  EXPECT_FALSE(together[0].Matrix().isApprox(together[1].Matrix(), 1e-3));
}

}  // namespace
}  // namespace recollect::cnn
