#include "recollect/cnn/trainer.h"

#include <gtest/gtest.h>
#include <torch/torch.h>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <limits>

#include "recollect/cnn/adam.h"
#include "recollect/cnn/checkpoint.h"
#include "recollect/cnn/loader.h"
#include "recollect/cnn/pair_network.h"
#include "recollect/cnn/test_street.h"
#include "recollect/cnn/threads.h"
#include "recollect/cnn/training_loss.h"
#include "recollect/core/error.h"
#include "recollect/core/files.h"

namespace recollect::cnn {
namespace {

// Eight pairs, seen over and over, must be learnt by heart: a network, a loss or an optimiser that
// is wired wrongly stays where it began.
TEST(Overfit, EightPairsAreLearntByHeart) {
  const TestStreet street(std::vector<testing::StreetDrive>{{.length_m = 10}});
  ThreadPool pool(1);
  SetThreads(1);
  PairData data = LoadPairs(street.laps(), street.laps(), Crop{160, 120, 0, 12, 160, 96}, {}, pool);
  std::vector<Pair> few;
  for (std::size_t i = 0; i < 8; ++i) few.push_back(data.pairs[i * data.pairs.size() / 8]);
  data.pairs = few;

  torch::manual_seed(1);
  const auto network = MakeNetwork(NetworkKind::kCompact, data.camera);
  const TrainingLoss loss(data.camera, TrainOptions::Compact().loss);
  Adam adam(*network, {.gradient_limit = 5});
  Loader loader(data, {.batch = 8});
  double first = 0, last = 0;
  constexpr int kSteps = 80;
  for (int step = 0; step < kSteps; ++step) {
    const Batch batch = loader.Next();
    const Losses losses = loss(network->forward(batch.live, batch.key), batch);
    losses.total.backward();
    adam.Step(1e-3);
    last = losses.projection.item<double>();
    if (step == 0) first = last;
  }
  EXPECT_LT(last, 0.4 * first) << "from " << first << " m";
}

TEST(AdamTest, FollowsItsDefinition) {
  torch::nn::Linear layer(1, 1);
  double mean = 0, square = 0, expected = layer->weight.item<double>();
  Adam adam(*layer, {});
  for (int step = 1; step <= 3; ++step) {
    (layer->weight * layer->weight).sum().backward();
    const double gradient = 2 * layer->weight.item<double>();
    mean = 0.9 * mean + 0.1 * gradient;
    square = 0.999 * square + 0.001 * gradient * gradient;
    expected -= 0.01 * (mean / (1 - std::pow(0.9, step))) /
                (std::sqrt(square / (1 - std::pow(0.999, step))) + 1e-8);
    adam.Step(0.01);
    EXPECT_NEAR(layer->weight.item<double>(), expected, 1e-6);
    EXPECT_FALSE(layer->weight.grad().defined());
  }
}

struct PowerCut {};

class TrainerTest : public ::testing::Test {
 protected:
  TrainOptions Options(const std::string& name) const {
    TrainOptions options = TrainOptions::Compact();
    options.epochs = 2;
    options.batch = 4;
    options.validate_steps = 2;
    options.validation_pairs = 2;
    options.pairs.max_distance_m = 1.6;
    options.threads = 1;  // exact equality is promised for one number of threads
    options.out = street_.File(name + ".model");
    options.csv = street_.File(name + ".csv");
    return options;
  }
  TrainResult Run(const TrainOptions& options, const ProgressSink& progress = {}) {
    return Train(std::span(street_.laps()).first(1), std::span(street_.laps()).last(1), options,
                 progress);
  }
  void RunUntilPowerCut(const TrainOptions& options) {
    EXPECT_THROW(Run(options, AtStep(3, [] { throw PowerCut(); })), PowerCut);
    ASSERT_TRUE(std::filesystem::exists(CheckpointPath(options)));
  }
  static ProgressSink AtStep(std::int64_t step, const std::function<void()>& act) {
    return [=](const Progress& progress) {
      if (progress.stage == "train" && progress.done == step) act();
    };
  }
  // The message of the error that the training ends with.
  std::string ErrorOf(const TrainOptions& options, const ProgressSink& progress = {}) {
    try {
      Run(options, progress);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }
  // Every curve and every weight is what the uninterrupted training `expected` has.
  void ExpectResumesAs(const TrainResult& expected, const std::filesystem::path& model,
                       TrainOptions options) {
    options.resume = true;
    options.stop = {};
    const TrainResult resumed = Run(options);
    EXPECT_EQ(resumed.steps, expected.steps);
    EXPECT_EQ(resumed.model.steps, expected.model.steps);
    ASSERT_EQ(resumed.curve.size(), expected.curve.size());
    for (std::size_t i = 0; i < expected.curve.size(); ++i) {
      EXPECT_EQ(resumed.curve[i].loss, expected.curve[i].loss) << i;
      EXPECT_EQ(resumed.curve[i].valid_position_m, expected.curve[i].valid_position_m) << i;
    }
    const TensorFile one = ReadTensorFile(options.out), other = ReadTensorFile(model);
    ASSERT_EQ(one.tensors.size(), other.tensors.size());
    for (std::size_t i = 0; i < one.tensors.size(); ++i) {
      EXPECT_TRUE(torch::equal(one.tensors[i].second, other.tensors[i].second))
          << one.tensors[i].first;
    }
  }

  TestStreet street_{{{.length_m = 8}, {.length_m = 8, .lateral_m = 0.5, .seed = 2}}};
};

TEST_F(TrainerTest, WritesTheBestModelAndItsCurve) {
  TrainOptions options = Options("plain");
  options.live = street_.File("plain.html");
  std::string while_running;
  const TrainResult result =
      Run(options, AtStep(3, [&] { while_running = ReadFile(options.live); }));
  EXPECT_NE(while_running.find("refresh"), std::string::npos);
  const std::string page = ReadFile(options.live);
  EXPECT_EQ(page.find("refresh"), std::string::npos);
  EXPECT_NE(page.find("<polyline"), std::string::npos);
  EXPECT_NE(page.find(fmt::format("<tr><td>{}<td>", result.steps)), std::string::npos);
  ASSERT_FALSE(result.curve.empty());
  double best = 1e9;
  for (const CurvePoint& point : result.curve) best = std::min(best, point.valid_position_m);
  // Training pairs are of 5 m at most, and what was learnt of them shows.
  EXPECT_LT(result.curve.front().train_position_m, 5);
  EXPECT_GT(result.curve.back().train_position_m, 0);
  EXPECT_LT(result.curve.back().train_position_m, result.curve.front().train_position_m);
  const ModelInfo info = PoseNetwork::Load(options.out, 1).info();
  EXPECT_EQ(info.validation.position_mean_m, best);
  EXPECT_EQ(info.laps, std::vector<std::string>{"lap-0"});
  EXPECT_EQ(info.validated_on, "live frames of lap-1");
  EXPECT_EQ(result.curve.back().step, result.steps);
  EXPECT_NE(ReadFile(options.csv).find("valid_position_m"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(CheckpointPath(options)));
}

TEST_F(TrainerTest, ResumedTrainingIsAsIfItHadNeverStopped) {
  const TrainResult expected = Run(Options("whole"));
  ASSERT_GT(expected.steps, 3);

  const TrainOptions broken = Options("broken");
  RunUntilPowerCut(broken);
  ExpectResumesAs(expected, Options("whole").out, broken);
}

TEST_F(TrainerTest, StopsWhenAskedAndGoesOnFromThere) {
  const TrainResult expected = Run(Options("whole"));
  TrainOptions options = Options("stopped");
  int asked = 0;
  options.stop = [&] { return ++asked > 3; };  // not where a validation writes a checkpoint
  EXPECT_NE(ErrorOf(options).find("stopped at step 3"), std::string::npos);
  ExpectResumesAs(expected, Options("whole").out, options);
}

TEST_F(TrainerTest, AFullDiskLeavesTheEarlierCheckpointWhole) {
  const TrainResult expected = Run(Options("whole"));
  const TrainOptions options = Options("full");
  rlimit unlimited{};
  getrlimit(RLIMIT_FSIZE, &unlimited);
  const auto before = std::signal(SIGXFSZ, SIG_IGN);
  std::string checkpoint;
  const std::string error = ErrorOf(options, AtStep(3, [&] {
                                      checkpoint = ReadFile(CheckpointPath(options));
                                      const rlimit full{100'000, unlimited.rlim_max};
                                      setrlimit(RLIMIT_FSIZE, &full);
                                    }));
  setrlimit(RLIMIT_FSIZE, &unlimited);
  std::signal(SIGXFSZ, before);
  EXPECT_NE(error.find("cannot be written"), std::string::npos) << error;
  ASSERT_FALSE(checkpoint.empty());
  EXPECT_EQ(ReadFile(CheckpointPath(options)), checkpoint);
  ExpectResumesAs(expected, Options("whole").out, options);
}

TEST_F(TrainerTest, EndsWhereNothingIsFiniteAnyMore) {
  Run(Options("sane"));
  TensorFile model = ReadTensorFile(Options("sane").out);
  for (auto& [name, tensor] : model.tensors) {
    if (name == "output.2.bias") tensor.fill_(std::numeric_limits<float>::quiet_NaN());
  }
  TrainOptions options = Options("broken");
  options.start = street_.File("broken.start");
  WriteTensorFile(options.start, model);
  options.epochs = 100;
  options.validate_steps = 1000;
  EXPECT_NE(ErrorOf(options).find("20 steps in a row"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(CheckpointPath(options)));
}

class LossKinds : public TrainerTest, public ::testing::WithParamInterface<const char*> {};

TEST_P(LossKinds, TrainAndResume) {
  TrainOptions whole = Options("whole"), broken = Options("broken");
  whole.loss.kind = broken.loss.kind = LossKindFromName(GetParam());
  const TrainResult expected = Run(whole);
  EXPECT_LT(expected.curve.back().train_position_m, expected.curve.front().train_position_m);
  RunUntilPowerCut(broken);
  ExpectResumesAs(expected, whole.out, broken);
}

INSTANTIATE_TEST_SUITE_P(All, LossKinds,
                         ::testing::Values("reprojection", "l2", "homoscedastic", "uncertainty"));

TEST_F(TrainerTest, TurnsAndMirrorsWhatIsTrainedOnOnly) {
  TrainOptions whole = Options("whole"), broken = Options("broken");
  whole.view = broken.view = {.turn_rad = 0.05, .mirror = true};
  const TrainResult expected = Run(whole), plain = Run(Options("plain"));
  EXPECT_NE(expected.curve.front().loss, plain.curve.front().loss);
  RunUntilPowerCut(broken);
  ExpectResumesAs(expected, whole.out, broken);

  const PoseNetwork network = PoseNetwork::Load(whole.out, 1);
  EXPECT_NE(network.info().options.find("\"turn_rad\":0.05"), std::string::npos);
  EXPECT_NE(network.info().options.find("\"mirror\":true"), std::string::npos);
  ThreadPool pool(1);
  const PairData data =
      LoadPairs(std::span(street_.laps()).last(1), std::span(street_.laps()).first(1),
                network.crop(), whole.pairs, pool);
  const std::vector<std::size_t> validated = {0, data.pairs.size() / 2};
  EXPECT_NEAR(EvaluatePairs(network, data, validated).Figures().position_mean_m,
              network.info().validation.position_mean_m, 1e-4);
}

TEST_F(TrainerTest, KeepsAveragedWeightsAndResumesThem) {
  TrainOptions whole = Options("whole"), broken = Options("broken"), plain = Options("plain");
  whole.average = broken.average = 0.5;
  const TrainResult averaged = Run(whole), last = Run(plain);
  // They lag behind the same training's own weights.
  ASSERT_EQ(averaged.curve.size(), last.curve.size());
  for (std::size_t i = 0; i < last.curve.size(); ++i) {
    EXPECT_EQ(averaged.curve[i].loss, last.curve[i].loss) << i;
    EXPECT_NE(averaged.curve[i].valid_position_m, last.curve[i].valid_position_m) << i;
  }
  RunUntilPowerCut(broken);
  ExpectResumesAs(averaged, whole.out, broken);
}

// With averages that leave nothing as it was, the weights are kept themselves.
TEST_F(TrainerTest, AnAverageOverNothingIsTheWeights) {
  TrainOptions averaged = Options("averaged"), plain = Options("plain");
  averaged.average = 1e-12;
  const TrainResult one = Run(averaged), other = Run(plain);
  EXPECT_NEAR(one.model.validation.position_mean_m, other.model.validation.position_mean_m, 1e-5);
}

// A covariance is put on a model that has none, and calibrated on the pairs that are validated.
TEST_F(TrainerTest, PutsACalibratedCovarianceOnAModel) {
  const TrainResult first = Run(Options("first"));
  EXPECT_FALSE(first.model.covariance);
  TrainOptions options = Options("second");
  options.start = Options("first").out;
  options.loss.kind = LossKind::kUncertainty;
  options.validation_pairs = 40;
  const TrainResult second = Run(options);
  const PoseNetwork network = PoseNetwork::Load(options.out, 1);
  ASSERT_TRUE(network.info().covariance);
  ThreadPool pool(1);
  const PairData data =
      LoadPairs(std::span(street_.laps()).last(1), std::span(street_.laps()).first(1),
                network.crop(), options.pairs, pool);
  std::vector<std::size_t> validated;  // as the training chose them
  const std::size_t count = std::min<std::size_t>(40, data.pairs.size());
  for (std::size_t i = 0; i < count; ++i) validated.push_back(i * data.pairs.size() / count);
  const PairFigures figures = EvaluatePairs(network, data, validated).Figures();
  ASSERT_TRUE(figures.inside_95);
  EXPECT_NEAR(*figures.inside_95, 0.95, 1.01 / static_cast<double>(count));
  EXPECT_NEAR(*figures.inside_95, *network.info().validation.inside_95, 1e-12);
  EXPECT_NE(second.curve.back().likelihood, 0);
  EXPECT_GT(network.info().steps, 0);  // not the fresh one, however good the model's motions were
  EXPECT_NE(ReadFile(options.csv).find(",likelihood"), std::string::npos);
}

// With its covariance a network learns the same motions: nothing flows back from there, not by way
// of the bound on the gradient's length either.
TEST_F(TrainerTest, TheCovarianceLeavesTheMotionAlone) {
  TrainOptions without = Options("without"), with = Options("with");
  without.gradient_limit = with.gradient_limit = 0.1;
  with.loss.kind = LossKind::kUncertainty;
  const TrainResult one = Run(without), other = Run(with);
  ASSERT_EQ(one.curve.size(), other.curve.size());
  for (std::size_t i = 0; i < one.curve.size(); ++i) {
    EXPECT_EQ(one.curve[i].valid_position_m, other.curve[i].valid_position_m) << i;
  }
}

TEST_F(TrainerTest, BeginsWithTheWeightsOfAModel) {
  const TrainResult first = Run(Options("first"));
  TrainOptions options = Options("second");
  options.start = Options("first").out;
  const TrainResult second = Run(options);
  EXPECT_EQ(second.curve.front().step, 0);
  EXPECT_EQ(second.curve.front().valid_position_m, first.model.validation.position_mean_m);
  EXPECT_LE(second.model.validation.position_mean_m, first.model.validation.position_mean_m);

  options.network = NetworkKind::kPaperB;
  EXPECT_THROW(Run(options), Error);
  options.start = "nowhere.model";
  EXPECT_THROW(Run(options), Error);
}

TEST_F(TrainerTest, RefusesForeignCheckpoints) {
  TrainOptions options = Options("other");
  RunUntilPowerCut(options);
  options.resume = true;
  options.learning_rate *= 2;
  EXPECT_THROW(Run(options), Error);
  options.learning_rate /= 2;
  options.view.mirror = true;
  EXPECT_THROW(Run(options), Error);
  AtomicWrite(CheckpointPath(options), "rubbish");
  EXPECT_THROW(Run(options), Error);
}

TEST_F(TrainerTest, RefusesOptionsOutOfRange) {
  const auto refuses = [&](auto change) {
    TrainOptions options = Options("wrong");
    change(options);
    EXPECT_THROW(Run(options), Error);
  };
  refuses([](TrainOptions& o) { o.epochs = 0; });
  refuses([](TrainOptions& o) { o.batch = -1; });
  refuses([](TrainOptions& o) { o.ranks.ranks = 3; });  // do not share out a batch of four
  refuses([](TrainOptions& o) { o.loss.beta = 0; });
  refuses([](TrainOptions& o) {
    o.network = NetworkKind::kPaperB;
    o.loss.kind = LossKind::kUncertainty;
  });
  refuses([](TrainOptions& o) { o.average = 1; });
  refuses([](TrainOptions& o) { o.view.turn_rad = -0.1; });
  refuses([](TrainOptions& o) { o.view.turn_rad = 0.5; });
  refuses([](TrainOptions& o) { o.learning_rate = 0; });
  refuses([](TrainOptions& o) { o.minutes = -1; });
  refuses([](TrainOptions& o) { o.validation_share = 1; });
  refuses([](TrainOptions& o) { o.out.clear(); });
  EXPECT_THROW(Train({}, {}, Options("none")), Error);
}

}  // namespace
}  // namespace recollect::cnn
