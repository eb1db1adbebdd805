#include "recollect/cnn/device.h"

#include <gtest/gtest.h>

#include "recollect/cnn/adam.h"
#include "recollect/cnn/pair_network.h"
#include "recollect/cnn/pose_network.h"
#include "recollect/cnn/stand_in_device.h"
#include "recollect/cnn/test_street.h"
#include "recollect/cnn/trainer.h"
#include "recollect/cnn/training_loss.h"
#include "recollect/core/error.h"

namespace recollect::cnn {
namespace {

const PinholeCamera kCamera{320, 240, 250, 250, 160, 120};

// The stand-in does its work: it crashes who reads its memory, and tells of what lies elsewhere.
TEST(StandIn, GuardsItsMemory) {
  const torch::Tensor there = torch::ones({3}).to(StandInDevice());
  EXPECT_TRUE(torch::equal((there * 2).cpu(), torch::full({3}, 2.F)));
  EXPECT_DEATH(std::exit(static_cast<int>(there.data_ptr<float>()[0])), "");
  EXPECT_THROW(there + torch::ones({3}), c10::Error);
  EXPECT_TRUE(torch::equal((there + torch::ones({})).cpu(), torch::full({3}, 2.F)));
}

// Everything that training does, on a device that is not the processor: the same curve.
TEST(Device, TrainsElsewhereAsOnTheProcessor) {
  const TestStreet street({{.length_m = 8}, {.length_m = 8, .lateral_m = 0.5, .seed = 2}});
  const auto run = [&](const std::string& device) {
    TrainOptions options = TrainOptions::Compact();
    options.epochs = 2;
    options.batch = 4;
    options.validate_steps = 2;
    options.validation_pairs = 2;
    options.pairs.max_distance_m = 1.6;
    options.average = 0.5;
    options.loss.kind = LossKind::kUncertainty;
    options.threads = 1;
    options.out = street.File(device + ".model");
    options.device = device;
    return Train(std::span(street.laps()).first(1), std::span(street.laps()).last(1), options);
  };
  const TrainResult expected = run("cpu"), got = run("xpu");
  ASSERT_GE(expected.steps, 4);
  ASSERT_EQ(got.curve.size(), expected.curve.size());
  for (std::size_t i = 0; i < expected.curve.size(); ++i) {
    const CurvePoint &one = got.curve[i], &other = expected.curve[i];
    EXPECT_NEAR(one.loss, other.loss, 1e-2 * std::abs(other.loss)) << i;
    EXPECT_NEAR(one.valid_position_m, other.valid_position_m, 0.02) << i;
  }
  // What it wrote answers on the processor.
  EXPECT_TRUE(PoseNetwork::Load(street.File("xpu.model"), 1).info().covariance);
}

TEST(Device, StepsThePapersNetworkElsewhere) {
  const auto step = [&](const torch::Device& device) {
    torch::manual_seed(3);
    const auto network = MakeNetwork(NetworkKind::kPaperB, kCamera);
    network->eval();  // dropout's noise is each device's own
    {
      const torch::NoGradGuard no_gradients;  // the output layer starts at zero
      for (auto& parameter : network->parameters()) {
        if (parameter.dim() == 4 && parameter.size(0) == 6) parameter.normal_(0, 1e-4);
      }
    }
    Batch batch{torch::rand({1, 3, 240, 320}), torch::rand({1, 3, 240, 320}),
                torch::eye(3, 4).unsqueeze(0), torch::full({1, 60, 80}, 10.F)};
    network->to(device);
    TrainingLoss loss(kCamera, {});
    loss.to(device);
    batch = batch.To(device);
    const Losses losses = loss(network->forward(batch.live, batch.key), batch);
    losses.total.backward();
    std::vector<torch::Tensor> gradients;
    for (const auto& parameter : network->parameters()) gradients.push_back(parameter.grad().cpu());
    Adam adam(*network, {.gradient_limit = 5});
    EXPECT_TRUE(adam.Step(1e-4));
    gradients.push_back(losses.total.detach().cpu());
    return gradients;
  };
  const auto expected = step(torch::kCPU), got = step(StandInDevice());
  ASSERT_EQ(got.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const double size = expected[i].abs().max().item<double>();
    ASSERT_GT(size, 0) << i;
    EXPECT_LT((got[i] - expected[i]).abs().max().item<double>(), 1e-3 * size) << i;
  }
}

TEST(Device, IsNamed) {
  EXPECT_EQ(DeviceNamed("cpu"), torch::Device(torch::kCPU));
  EXPECT_THROW(DeviceNamed("toaster"), Error);
  if (torch::cuda::is_available()) GTEST_SKIP() << "there is a graphics card here";
  EXPECT_EQ(DeviceNamed("", 3), torch::Device(torch::kCPU));
  EXPECT_THROW(DeviceNamed("cuda"), Error);
}

}  // namespace
}  // namespace recollect::cnn
