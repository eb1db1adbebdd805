#include "recollect/cnn/trainer.h"

#include <torch/torch.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "recollect/cnn/adam.h"
#include "recollect/cnn/checkpoint.h"
#include "recollect/cnn/device.h"
#include "recollect/cnn/live_curve.h"
#include "recollect/cnn/loader.h"
#include "recollect/cnn/pair_network.h"
#include "recollect/cnn/pose_network.h"
#include "recollect/cnn/ranks.h"
#include "recollect/cnn/threads.h"
#include "recollect/cnn/training_data.h"
#include "recollect/cnn/training_loss.h"
#include "recollect/core/error.h"
#include "recollect/core/random.h"
#include "recollect/core/stopwatch.h"

namespace recollect::cnn {
namespace {

constexpr int kBadStepsInARow = 20;         // after which training is given up
constexpr double kSecondsBetweenPages = 5;  // of the live curve

void AddLosses(const Losses& losses, TrainingState& state) {
  const auto add = [](double& sum, const torch::Tensor& value) {
    if (value.defined()) sum += value.item<double>();
  };
  add(state.sums.loss, losses.total);
  add(state.sums.projection_m, losses.projection);
  add(state.sums.correspondence, losses.correspondence);
  add(state.sums.depth, losses.depth);
  add(state.sums.likelihood, losses.likelihood);
  add(state.sums.train_position_m, losses.position_m);
  ++state.sum_steps;
}

// Means of the losses since the last validation.
CurvePoint TakeMeans(TrainingState& state) {
  CurvePoint mean = std::exchange(state.sums, {});
  const auto count =
      static_cast<double>(std::max<std::int64_t>(1, std::exchange(state.sum_steps, 0)));
  for (double* value : {&mean.loss, &mean.projection_m, &mean.correspondence, &mean.depth,
                        &mean.likelihood, &mean.train_position_m}) {
    *value /= count;
  }
  return mean;
}

// What is optimised: the network, and the loss where that has parameters of its own.
class Trained : public torch::nn::Module {
 public:
  Trained(std::shared_ptr<PairNetwork> network, std::shared_ptr<TrainingLoss> loss) {
    register_module("network", std::move(network));
    register_module("loss", std::move(loss));
  }
};

// A copy of the network whose weights follow the network's own.
class AveragedNetwork {
 public:
  AveragedNetwork(std::shared_ptr<PairNetwork> copy, const PairNetwork& of, double decay)
      : copy_(std::move(copy)), decay_(decay) {
    Follow(of, 0);
  }

  // After so many steps.
  void Update(const PairNetwork& of, std::int64_t steps) {
    const auto count = static_cast<double>(steps);
    Follow(of, std::min(decay_, (1 + count) / (10 + count)));
  }

  const std::shared_ptr<PairNetwork>& network() const { return copy_; }

 private:
  void Follow(const PairNetwork& of, double keep) {
    const torch::NoGradGuard no_gradients;
    const auto from = of.parameters();
    const auto to = copy_->parameters();
    for (std::size_t i = 0; i < to.size(); ++i) {
      torch::Tensor average = to[i];
      average.lerp_(from[i], 1 - keep);
    }
  }

  std::shared_ptr<PairNetwork> copy_;
  double decay_;
};

class Trainer {
 public:
  Trainer(const TrainingData& data, const TrainOptions& options, const Stopwatch& watch,
          const ProgressSink& progress)
      : data_(data),
        options_(options),
        watch_(watch),
        progress_(progress),
        per_epoch_(Loader::BatchesPerEpoch(data.train, options.batch)),
        total_steps_(per_epoch_ * options.epochs),
        device_(DeviceNamed(options.device, options.ranks.rank)),
        ranks_(options.ranks) {
    torch::manual_seed(SubSeed(options.seed, 0));
    network_ = MakeNetwork(options.network, data.train.camera, PredictsCovariance());
    if (!options.start.empty()) {
      const ModelInfo start = CopyWeights(options.start, options.network, *network_);
      fresh_covariance_ = PredictsCovariance() && !start.covariance;
    }
    Require(options.precision == Precision::kFloat32 || device_.is_cpu(), "bfloat16",
            "is trained in on the processor only");
    network_->TrainIn(options.precision);
    Divisor divisor;
    if (ranks_.ranks() > 1) {
      divisor = [this](const torch::Tensor& weights) {
        torch::Tensor mean = weights.detach().clone();
        ranks_.Mean(mean);
        return mean;
      };
    }
    loss_ = std::make_shared<TrainingLoss>(data.train.camera, options.loss, divisor);
    trained_ = std::make_shared<Trained>(network_, loss_);
    trained_->to(device_);
    if (options.average > 0) {
      auto copy = MakeNetwork(options.network, data.train.camera, PredictsCovariance());
      copy->to(device_);
      average_.emplace(std::move(copy), *network_, options.average);
    }
    adam_ = std::make_unique<Adam>(
        *trained_, AdamOptions{.weight_decay = options.weight_decay,
                               .gradient_limit = options.gradient_limit,
                               .apart = fmt::format("network.{}", kCovarianceWeights)});
  }

  TrainResult Run() {
    if (options_.resume) Resume();
    Loader loader(data_.train,
                  {options_.network, options_.batch, options_.augment, options_.seed, ranks_.rank(),
                   ranks_.ranks(), options_.view},
                  state_.step);
    const std::int64_t every = options_.validate_steps > 0 ? options_.validate_steps : per_epoch_;
    if (!options_.start.empty() && state_.step == 0) Validate();  // it may be the best already
    try {
      while (AllGoOn()) {
        Step(loader.Next().To(device_));
        if (state_.step % every == 0) Validate();
      }
    } catch (const Error&) {
      // A rank was lost, or the numbers: what was learnt before that step is kept.
      if (First() && ranks_.ranks() > 1) Keep();
      throw;
    }
    if (!First()) return {{}, state_.step, Seconds(), {}};
    if (state_.curve.empty() || state_.curve.back().step != state_.step) Validate();
    return Finish();
  }

 private:
  bool First() const { return ranks_.rank() == 0; }

  // Whether there is another step to make, and at what rate: the first rank says, for time passes
  // differently elsewhere. Anyone may want to stop.
  bool AllGoOn() {
    const bool stop = options_.stop && options_.stop();
    const torch::Tensor said =
        torch::tensor({stop ? 1.0 : 0.0, First() && Finished() ? 1.0 : 0.0,
                       First() ? LearningRate() : 0.0, static_cast<double>(state_.step)},
                      torch::kDouble);
    ranks_.Sum(said);
    const auto* values = said.data_ptr<double>();
    Require(values[3] == static_cast<double>(state_.step * ranks_.ranks()), "ranks",
            "begin at different steps", "give all of them the same checkpoint");
    rate_ = values[2];
    if (values[1] > 0) return false;
    if (values[0] > 0) {
      if (First()) Keep();
      throw Error("train",
                  fmt::format("stopped at step {}, which is kept in '{}'", state_.step,
                              CheckpointPath(options_).string()),
                  "go on with --resume");
    }
    return true;
  }

  // The network that is validated and written.
  const std::shared_ptr<PairNetwork>& Judged() const {
    return average_ ? average_->network() : network_;
  }

  PairNetwork* Average() const { return average_ ? average_->network().get() : nullptr; }

  void Keep() const {
    WriteCheckpoint(CheckpointPath(options_), Saved(), *trained_, *adam_, Average());
  }

  double Seconds() const { return state_.seconds_before + watch_.Seconds(); }

  // How much of the training is done, by steps or by time, whichever is further.
  double Done() const {
    const double steps = static_cast<double>(state_.step) / static_cast<double>(total_steps_);
    return options_.minutes > 0 ? std::max(steps, Seconds() / (60 * options_.minutes)) : steps;
  }

  bool Finished() const {
    if (state_.step >= total_steps_) return true;
    // One more step and the last validation come out of the budget too; they may take longer than
    // those before.
    const double to_come = 1.5 * (step_seconds_ + ValidationSeconds());
    if (options_.minutes > 0 && Seconds() + to_come > 60 * options_.minutes) return true;
    return options_.patience > 0 && state_.without_gain >= options_.patience;
  }

  // Of the next validation; before the first one, by the steps: forward is less than half of a
  // step.
  double ValidationSeconds() const {
    if (validation_seconds_ > 0) return validation_seconds_;
    return 0.5 * step_seconds_ * static_cast<double>(data_.quick_valid.size()) / options_.batch;
  }

  double LearningRate() const {
    double rate = options_.learning_rate;
    if (options_.schedule == Schedule::kCosine) {
      rate *= 0.5 * (1 + std::cos(std::numbers::pi * std::min(1.0, Done())));
    } else {
      rate *= std::pow(0.5, static_cast<double>(state_.step / per_epoch_));
    }
    const auto next = static_cast<double>(state_.step + 1);
    return options_.warm_up_steps > 0 ? rate * std::min(1.0, next / options_.warm_up_steps) : rate;
  }

  void Step(const Batch& batch) {
    const Stopwatch step;
    // Dropout's noise follows from the step, so that a resumed training sees the same.
    const auto noise = SubSeed(SubSeed(options_.seed, 3), static_cast<std::uint64_t>(state_.step));
    torch::manual_seed(First() ? noise : SubSeed(noise, static_cast<std::uint64_t>(ranks_.rank())));
    network_->train();
    const Losses losses = (*loss_)(network_->forward(batch.live, batch.key), batch);
    losses.total.backward();
    if (!losses.total.isfinite().item<bool>()) {  // its gradient may be; all ranks are to see it
      torch::Tensor& gradient = trained_->parameters().front().mutable_grad();
      if (gradient.defined()) gradient.fill_(std::numeric_limits<float>::quiet_NaN());
    }
    ranks_.MeanGradients(*trained_);
    const bool good = adam_->Step(rate_);
    ++state_.step;
    if (average_) average_->Update(*network_, state_.step);
    if (good) AddLosses(losses, state_);
    Guard(good);
    step_seconds_ = step.Seconds();
    ShowPage();
    Report(progress_, "train", state_.step, ExpectedSteps(),
           fmt::format("loss {:.3f}  valid {:.3f} m", losses.total.item<double>(),
                       state_.curve.empty() ? 0.0 : state_.curve.back().valid_position_m));
  }

  // A step whose gradient is not finite leaves the weights alone; many in a row are the end.
  void Guard(bool good) {
    bad_steps_ = good ? 0 : bad_steps_ + 1;
    if (good) return;
    ++state_.skipped;
    if (bad_steps_ < kBadStepsInARow) return;
    if (First()) Keep();
    throw Error("train",
                fmt::format("{} steps in a row had a loss or a gradient that is not finite; the "
                            "weights before them are kept in '{}'",
                            bad_steps_, CheckpointPath(options_).string()),
                "try a lower learning rate");
  }

  void ShowPage(bool running = true) {
    if (!First() || options_.live.empty()) return;
    if (running && page_.Seconds() < kSecondsBetweenPages && shown_) return;
    shown_ = true;
    page_.Restart();
    WriteLiveCurve(
        options_.live, state_.curve,
        fmt::format("{}: step {} of about {}, {:.0f} s{}{}", options_.out.string(), state_.step,
                    ExpectedSteps(), Seconds(),
                    state_.skipped > 0 ? fmt::format(", {} steps left out", state_.skipped) : "",
                    running ? "" : ", done"),
        running);
  }

  std::int64_t ExpectedSteps() const {
    const double done = Done();
    if (done <= 0) return total_steps_;
    return std::min(total_steps_,
                    static_cast<std::int64_t>(static_cast<double>(state_.step) / done) + 1);
  }

  void Validate() {
    if (!First()) return;
    const Stopwatch validation;
    CurvePoint point = TakeMeans(state_);
    PairErrors errors =
        EvaluatePairs(PoseNetwork(Describe({}, {}), Judged()), data_.valid, data_.quick_valid);
    const CovarianceCalibration calibration = errors.Calibration();
    errors.Apply(calibration);
    const PairFigures figures = errors.Figures();
    point.step = state_.step;
    point.epoch = static_cast<double>(state_.step) / static_cast<double>(per_epoch_);
    point.seconds = Seconds();
    point.learning_rate = rate_;
    point.valid_position_m = figures.position_mean_m;
    point.valid_heading_deg = figures.heading_mean_deg;
    state_.curve.push_back(point);
    ++state_.without_gain;
    if (figures.position_mean_m < state_.best_m) {
      // A covariance that has learnt nothing yet is kept only until there is another.
      if (state_.step > 0 || !fresh_covariance_) state_.best_m = figures.position_mean_m;
      state_.without_gain = 0;
      PoseNetwork(Describe(figures, calibration), Judged()).Save(options_.out);
    }
    WriteCurve(options_.csv, state_.curve);
    Keep();
    validation_seconds_ = validation.Seconds();
  }

  bool PredictsCovariance() const { return options_.loss.kind == LossKind::kUncertainty; }

  ModelInfo Describe(const PairFigures& figures, const CovarianceCalibration& calibration) const {
    ModelInfo info;
    info.network = options_.network;
    info.crop = data_.train.crop;
    info.camera = data_.train.camera;
    info.seed = options_.seed;
    info.laps = data_.laps;
    info.training_pairs = static_cast<std::int64_t>(data_.train.pairs.size());
    info.steps = state_.step;
    info.seconds = Seconds();
    for (const auto& parameter : network_->parameters()) info.parameters += parameter.numel();
    info.validated_on = data_.validated_on;
    info.validation = figures;
    if (PredictsCovariance()) info.covariance = calibration;
    info.options = ToJson(options_);
    return info;
  }

  TrainingState Saved() const {
    TrainingState state = state_;
    state.seconds_before = Seconds();
    state.options = ToJson(options_);
    return state;
  }

  void Resume() {
    const auto path = CheckpointPath(options_);
    if (!std::filesystem::exists(path)) return;
    state_ = ReadCheckpoint(path, ToJson(options_), *trained_, *adam_, Average());
  }

  TrainResult Finish() {
    ShowPage(false);
    const ModelInfo best = PoseNetwork::Load(options_.out, options_.threads).info();
    std::filesystem::remove(CheckpointPath(options_));
    return {best, state_.step, Seconds(), state_.curve};
  }

  const TrainingData& data_;
  const TrainOptions& options_;
  const Stopwatch& watch_;
  const ProgressSink& progress_;
  const std::int64_t per_epoch_, total_steps_;
  const torch::Device device_;
  const Ranks ranks_;
  std::shared_ptr<PairNetwork> network_;
  std::shared_ptr<TrainingLoss> loss_;
  std::shared_ptr<Trained> trained_;
  std::unique_ptr<Adam> adam_;
  std::optional<AveragedNetwork> average_;
  TrainingState state_;
  double rate_ = 0, step_seconds_ = 0, validation_seconds_ = 0;
  int bad_steps_ = 0;
  bool shown_ = false, fresh_covariance_ = false;
  Stopwatch page_;  // since the live curve was last written
};

}  // namespace

TrainResult Train(std::span<const Lap> laps, std::span<const Lap> valid,
                  const TrainOptions& options, const ProgressSink& progress) {
  const Stopwatch watch;
  RequireSensible(options);
  SetThreads(options.threads);
  ThreadPool pool(options.threads);
  const TrainingData data = LoadTrainingData(laps, valid, options, pool, progress);
  return Trainer(data, options, watch, progress).Run();
}

}  // namespace recollect::cnn
