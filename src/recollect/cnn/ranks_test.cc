#include "recollect/cnn/ranks.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <functional>

#include "recollect/cnn/checkpoint.h"
#include "recollect/cnn/pair_network.h"
#include "recollect/cnn/tensor_file.h"
#include "recollect/cnn/test_street.h"
#include "recollect/cnn/threads.h"
#include "recollect/cnn/trainer.h"
#include "recollect/cnn/training_loss.h"
#include "recollect/core/error.h"

namespace recollect::cnn {
namespace {

RankOptions RankOf(int rank) {
  return {.rank = rank, .ranks = 2, .port = 20000 + getppid() % 20000, .timeout_s = 60};
}

// Runs rank 0 and rank 1 in processes of their own, each with one thread; their exit codes. (The
// parent may hold threads that a fork does not take along.)
std::array<int, 2> RunBoth(const std::function<int(const RankOptions&)>& body) {
  std::array<pid_t, 2> children;
  for (int rank = 0; rank < 2; ++rank) {
    children[static_cast<std::size_t>(rank)] = fork();
    if (children[static_cast<std::size_t>(rank)] != 0) continue;
    try {
      SetThreads(1);
      _exit(body(RankOf(rank)));
    } catch (const Error&) {
      _exit(10);
    } catch (...) {
      _exit(20);
    }
  }
  std::array<int, 2> codes;
  for (std::size_t i = 0; i < 2; ++i) {
    int status = 0;
    waitpid(children[i], &status, 0);
    codes[i] = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  return codes;
}

constexpr std::array<int, 2> kWell = {0, 0};

class RanksTest : public ::testing::Test {
 protected:
  TrainOptions Options(const std::string& name) const {
    TrainOptions options = TrainOptions::Compact();
    options.batch = 4;
    options.epochs = 2;
    options.validate_steps = 2;
    options.validation_pairs = 2;
    options.pairs.max_distance_m = 1.6;
    options.threads = 1;
    options.out = street_.File(name + ".model");
    return options;
  }
  TrainResult Run(const TrainOptions& options, const ProgressSink& progress = {}) const {
    return Train(std::span(street_.laps()).first(1), std::span(street_.laps()).last(1), options,
                 progress);
  }

  TestStreet street_{{{.length_m = 8}, {.length_m = 8, .lateral_m = 0.5, .seed = 2}}};
};

// Gradients of a batch in one process and of its halves in two; depths are known for different
// shares of the halves' pixels, so plain means of means would differ.
TEST_F(RanksTest, GradientsAreThoseOfOneProcess) {
  const auto gradients = [&](const RankOptions* rank_options) {
    const PinholeCamera camera{160, 96, 120, 120, 80, 48};
    torch::manual_seed(1);
    const auto network = MakeNetwork(NetworkKind::kCompact, camera);
    for (auto& parameter : network->parameters()) {
      const torch::NoGradGuard no_gradients;
      if (parameter.abs().max().item<float>() == 0) parameter.normal_(0, 0.01);
    }
    Batch batch;
    batch.live = torch::randn({4, 3, 96, 160});
    batch.key = torch::randn({4, 3, 96, 160});
    batch.motion = torch::eye(3, 4).repeat({4, 1, 1});
    batch.motion.select(2, 3).normal_(0, 0.5);
    const PinholeCamera grid = camera.Subsampled(kDepthStep);
    batch.depth = torch::rand({4, grid.height, grid.width}) * 20 + 3;
    batch.depth.narrow(0, 0, 2).narrow(1, 0, grid.height / 2).zero_();
    Divisor divisor;
    std::unique_ptr<Ranks> ranks;
    if (rank_options != nullptr) {
      ranks = std::make_unique<Ranks>(*rank_options);
      const std::int64_t from = 2 * rank_options->rank;
      for (torch::Tensor* part : {&batch.live, &batch.key, &batch.motion, &batch.depth}) {
        *part = part->narrow(0, from, 2);
      }
      divisor = [&](const torch::Tensor& weights) {
        torch::Tensor mean = weights.detach().clone();
        ranks->Mean(mean);
        return mean;
      };
    }
    const TrainingLoss loss(camera, TrainOptions::Compact().loss, divisor);
    loss(network->forward(batch.live, batch.key), batch).total.backward();
    if (ranks) ranks->MeanGradients(*network);
    std::vector<torch::Tensor> all;
    for (const auto& parameter : network->parameters()) all.push_back(parameter.grad());
    return all;
  };
  EXPECT_EQ(RunBoth([&](const RankOptions& options) {
              const auto together = gradients(&options), alone = gradients(nullptr);
              for (std::size_t i = 0; i < alone.size(); ++i) {
                const double scale = std::max(1.0, alone[i].abs().max().item<double>());
                const double difference = (together[i] - alone[i]).abs().max().item<double>();
                if (!(difference < 1e-5 * scale)) return 1;
              }
              return 0;
            }),
            kWell);
}

TEST_F(RanksTest, TrainsAsOneProcessDoes) {
  EXPECT_EQ(RunBoth([&](const RankOptions& ranks) {
              TrainOptions options = Options("together");
              options.ranks = ranks;
              const TrainResult together = Run(options);
              if (ranks.rank != 0) return together.curve.empty() ? 0 : 1;
              const TrainResult alone = Run(Options("alone"));
              if (together.curve.size() != alone.curve.size()) return 2;
              // Steps multiply small differences; the first curve point has seen two.
              const auto &one = together.curve.front(), &other = alone.curve.front();
              if (std::abs(one.valid_position_m - other.valid_position_m) > 1e-3) return 3;
              return std::abs(one.depth - other.depth) < 0.5 ? 0 : 4;
            }),
            kWell);
}

TEST_F(RanksTest, ALostRankLeavesACheckpointToGoOnFrom) {
  TrainOptions options = Options("lost");
  const auto codes = RunBoth([&](const RankOptions& ranks) {
    TrainOptions own = options;
    own.ranks = ranks;
    Run(own, [&](const Progress& progress) {
      if (ranks.rank == 1 && progress.stage == "train" && progress.done == 3) _exit(7);
    });
    return 0;
  });
  EXPECT_EQ(codes, (std::array<int, 2>{10, 7}));  // an Error here, the loss itself there
  ASSERT_TRUE(std::filesystem::exists(CheckpointPath(options)));
  SetThreads(1);
  options.resume = true;
  EXPECT_GT(Run(options).steps, 3);
}

TEST(RankOptionsOf, TheEnvironment) {
  const auto set = [](const char* world, const char* rank) {
    setenv("WORLD_SIZE", world, 1);
    setenv("RANK", rank, 1);
    setenv("MASTER_PORT", "1234", 1);
  };
  set("4", "3");
  const RankOptions options = RankOptionsFromEnvironment();
  EXPECT_EQ(options.ranks, 4);
  EXPECT_EQ(options.rank, 3);
  EXPECT_EQ(options.port, 1234);
  for (const auto& [world, rank] : {std::pair{"4", "4"}, {"0", "0"}, {"x", "0"}, {"2", "-1"}}) {
    set(world, rank);
    EXPECT_THROW(RankOptionsFromEnvironment(), Error) << world << ", " << rank;
  }
  for (const char* name : {"WORLD_SIZE", "RANK", "MASTER_PORT"}) unsetenv(name);
  EXPECT_EQ(RankOptionsFromEnvironment().ranks, 1);
}

}  // namespace
}  // namespace recollect::cnn
