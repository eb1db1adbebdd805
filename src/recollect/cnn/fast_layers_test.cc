#include "recollect/cnn/fast_layers.h"

#include <gtest/gtest.h>

#include "recollect/cnn/adam.h"
#include "recollect/cnn/paper_network.h"

namespace recollect::cnn {
namespace {

double Difference(const torch::Tensor& a, const torch::Tensor& b) {
  return (a - b).abs().max().item<double>() / std::max(1e-12, b.abs().max().item<double>());
}

struct Shape {
  std::vector<std::int64_t> input, kernel;
  std::int64_t stride, padding;
};

// The paper's two wide layers in its networks A and B, and one that sees all its cells.
class ConvolveAsProductTest : public ::testing::TestWithParam<Shape> {};

TEST_P(ConvolveAsProductTest, HasLibtorchsValuesAndGradients) {
  torch::manual_seed(4);
  const Shape shape = GetParam();
  torch::nn::Conv2d layer(
      torch::nn::Conv2dOptions(shape.input[0], 24, {shape.kernel[0], shape.kernel[1]})
          .stride(shape.stride)
          .padding(shape.padding));
  layer->weight.set_data(layer->weight.contiguous(torch::MemoryFormat::ChannelsLast));
  std::vector<std::vector<torch::Tensor>> results;
  for (const bool ours : {false, true}) {
    torch::manual_seed(5);
    const torch::Tensor x =
        torch::randn({3, shape.input[0], shape.input[1], shape.input[2]}).requires_grad_(true);
    const torch::Tensor y = ours ? ConvolveAsProduct(x, *layer) : layer->forward(x);
    layer->zero_grad();
    (y * torch::randn(y.sizes())).sum().backward();
    results.push_back({y, x.grad(), layer->weight.grad().clone(), layer->bias.grad().clone()});
  }
  for (std::size_t i = 0; i < results[0].size(); ++i) {
    EXPECT_LT(Difference(results[1][i], results[0][i]), 1e-5) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, ConvolveAsProductTest,
                         ::testing::Values(Shape{{16, 2, 3}, {3, 3}, 2, 1},
                                           Shape{{16, 1, 2}, {1, 2}, 1, 1},
                                           Shape{{16, 1, 2}, {3, 3}, 2, 1},
                                           Shape{{16, 1, 1}, {1, 1}, 1, 0},
                                           Shape{{16, 4, 4}, {3, 3}, 1, 1}));

TEST(RectifyInPlaceTest, HasLibtorchsValuesAndGradients) {
  for (const float slope : {0.25F, 1.5F, 0.F, -0.5F}) {  // the last two go libtorch's own way
    torch::manual_seed(6);
    torch::nn::Conv2d layer(3, 5, 3);
    const torch::Tensor x =
        torch::randn({2, 3, 9, 11}).contiguous(torch::MemoryFormat::ChannelsLast);
    std::vector<std::vector<torch::Tensor>> results;
    for (const bool ours : {false, true}) {
      const torch::Tensor factor = torch::full({1}, slope).requires_grad_(true);
      torch::manual_seed(7);
      const torch::Tensor y = ours ? RectifyInPlace(layer->forward(x), factor)
                                   : torch::prelu(layer->forward(x), factor);
      layer->zero_grad();
      (y * torch::randn(y.sizes())).sum().backward();
      results.push_back({y, factor.grad(), layer->weight.grad().clone()});
    }
    for (std::size_t i = 0; i < results[0].size(); ++i) {
      EXPECT_LT(Difference(results[1][i], results[0][i]), 1e-5) << slope << ", " << i;
    }
  }
}

// What is rounded to eight bits is at most half of the last away from what is not.
TEST(RectifyInPlaceTest, OfBfloat16IsTheSameRounded) {
  torch::manual_seed(6);
  const torch::Tensor exact = torch::randn({2, 3, 9, 11}).to(torch::kBFloat16);
  const torch::Tensor pull = torch::randn({2, 3, 9, 11}).to(torch::kBFloat16);
  std::vector<std::vector<torch::Tensor>> results;
  for (const auto type : {torch::kFloat, torch::kBFloat16}) {
    const torch::Tensor x = exact.detach().to(type).clone().requires_grad_(true);
    const torch::Tensor slope = torch::full({1}, 0.25F).requires_grad_(true);
    const torch::Tensor y = RectifyInPlace(x * 1, slope);
    y.backward(pull.to(type));
    EXPECT_EQ(y.scalar_type(), type);
    results.push_back({y, x.grad(), slope.grad()});
  }
  for (std::size_t i = 0; i < results[0].size(); ++i) {
    const torch::Tensor expected = results[0][i];
    const torch::Tensor off = (results[1][i].to(torch::kFloat) - expected).abs();
    EXPECT_TRUE((off <= expected.abs() / 256 + 1e-6).all().item<bool>()) << i;
  }
  torch::Tensor none = torch::full({1, 1, 4, 4}, std::nan("")).to(torch::kBFloat16);
  EXPECT_TRUE(RectifyInPlace(none, torch::full({1}, 0.25F)).isnan().all().item<bool>());
}

// The whole network: every parameter's gradient is that of libtorch's own layers.
TEST(PaperNetworkTraining, HasLibtorchsGradients) {
  torch::manual_seed(8);
  PaperNetwork network(NetworkKind::kPaperA);
  {
    const torch::NoGradGuard no_gradients;
    for (auto& parameter : network.parameters()) {
      if (parameter.dim() == 4 && parameter.size(0) == 6) parameter.normal_(0, 0.002);
    }
  }
  network.train();
  const torch::Tensor live = torch::rand({2, 3, 240, 320}), key = torch::rand({2, 3, 240, 320});
  const torch::Tensor weights = torch::randn({2, 3, 4});
  std::vector<std::vector<torch::Tensor>> gradients(2);
  for (const bool ours : {false, true}) {
    torch::manual_seed(9);  // of the dropout
    const Prediction prediction =
        ours ? network.forward(live, key) : network.ForwardPlain(live, key);
    (prediction.motion * weights).sum().backward();
    for (auto& parameter : network.parameters()) {
      gradients[ours].push_back(parameter.grad().clone());
      parameter.mutable_grad().reset();
    }
  }
  for (std::size_t i = 0; i < gradients[0].size(); ++i) {
    EXPECT_LT(Difference(gradients[1][i], gradients[0][i]), 2e-3) << i;
  }
}

// In bfloat16 gradients point where they did, and nothing of it is left where one only asks.
TEST(PaperNetworkTraining, InBfloat16HasNearlyTheSameGradients) {
  torch::manual_seed(8);
  PaperNetwork network(NetworkKind::kPaperB);
  {
    const torch::NoGradGuard no_gradients;
    for (auto& parameter : network.parameters()) {
      if (parameter.dim() == 4 && parameter.size(0) == 6) parameter.normal_(0, 0.002);
    }
  }
  const torch::Tensor live = torch::rand({2, 3, 240, 320}), key = torch::rand({2, 3, 240, 320});
  const torch::Tensor weights = torch::randn({2, 3, 4});
  std::vector<std::vector<torch::Tensor>> gradients, motions;
  for (const Precision precision : {Precision::kFloat32, Precision::kBfloat16}) {
    network.TrainIn(precision);
    network.train();
    torch::manual_seed(9);  // of the dropout
    const Prediction learning = network.forward(live, key);
    (learning.motion * weights).sum().backward();
    gradients.emplace_back();
    for (auto& parameter : network.parameters()) {
      EXPECT_EQ(parameter.grad().scalar_type(), torch::kFloat);
      gradients.back().push_back(parameter.grad().flatten().clone());
      parameter.mutable_grad().reset();
    }
    network.eval();
    motions.push_back({learning.motion, network.forward(live, key).motion});
  }
  for (std::size_t i = 0; i < gradients[0].size(); ++i) {
    EXPECT_GT(torch::cosine_similarity(gradients[0][i], gradients[1][i], 0).item<double>(), 0.98)
        << i;
  }
  EXPECT_FALSE(torch::equal(motions[0][0], motions[1][0]));
  EXPECT_TRUE(torch::equal(motions[0][1], motions[1][1]));
}

TEST(AdamTest, StepsInOnePassAsByTensors) {
  // Gradients of another order than the weights' are walked through by tensors.
  torch::manual_seed(10);
  torch::nn::Conv2d one(3, 4, 3), other(3, 4, 3);
  other->weight.set_data(one->weight.clone());
  other->bias.set_data(one->bias.clone());
  const AdamOptions options{.weight_decay = 0.1, .gradient_limit = 0.5};
  Adam walked(*one, options), tensors(*other, options);
  for (int step = 0; step < 3; ++step) {
    const torch::Tensor gradient = torch::randn(one->weight.sizes());
    one->weight.mutable_grad() = gradient;
    other->weight.mutable_grad() = gradient.contiguous(torch::MemoryFormat::ChannelsLast);
    EXPECT_TRUE(walked.Step(0.01));
    EXPECT_TRUE(tensors.Step(0.01));
  }
  EXPECT_LT(Difference(one->weight, other->weight), 1e-6);
}

TEST(AdamTest, LeavesAStepOutWhoseGradientIsNotFinite) {
  torch::nn::Linear layer(2, 2);
  Adam adam(*layer, {});
  const torch::Tensor before = layer->weight.clone();
  layer->weight.mutable_grad() = torch::full({2, 2}, std::nan(""));
  layer->bias.mutable_grad() = torch::ones({2});
  EXPECT_FALSE(adam.Step(0.1));
  EXPECT_TRUE(torch::equal(layer->weight, before));
  EXPECT_FALSE(layer->bias.grad().defined());
  for (const auto& [name, tensor] : adam.State()) EXPECT_EQ(tensor.abs().max().item<float>(), 0);
  layer->weight.mutable_grad() = torch::ones({2, 2});
  EXPECT_TRUE(adam.Step(0.1));
  EXPECT_LT((before - 0.1 - layer->weight).abs().max().item<double>(), 1e-6);
}

}  // namespace
}  // namespace recollect::cnn
