#include "recollect/cnn/trainer.h"

#include <torch/torch.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "recollect/cnn/adam.h"
#include "recollect/cnn/checkpoint.h"
#include "recollect/cnn/loader.h"
#include "recollect/cnn/pair_network.h"
#include "recollect/cnn/pose_network.h"
#include "recollect/cnn/threads.h"
#include "recollect/cnn/training_data.h"
#include "recollect/cnn/training_loss.h"
#include "recollect/core/error.h"
#include "recollect/core/random.h"
#include "recollect/core/stopwatch.h"

namespace recollect::cnn {
namespace {

// Means of the losses since the last validation.
class LossMeans {
 public:
  void Add(const Losses& losses) {
    const auto add = [](double& sum, const torch::Tensor& value) {
      if (value.defined()) sum += value.item<double>();
    };
    add(sum_.loss, losses.total);
    add(sum_.projection_m, losses.projection);
    add(sum_.correspondence, losses.correspondence);
    add(sum_.depth, losses.depth);
    add(sum_.train_position_m, losses.position_m);
    ++count_;
  }
  CurvePoint Take() {
    CurvePoint mean = std::exchange(sum_, {});
    const double count = std::max(1, std::exchange(count_, 0));
    for (double* value : {&mean.loss, &mean.projection_m, &mean.correspondence, &mean.depth,
                          &mean.train_position_m}) {
      *value /= count;
    }
    return mean;
  }

 private:
  CurvePoint sum_;
  int count_ = 0;
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
        total_steps_(per_epoch_ * options.epochs) {
    torch::manual_seed(SubSeed(options.seed, 0));
    network_ = MakeNetwork(options.network, data.train.camera);
    if (!options.start.empty()) CopyWeights(options.start, options.network, *network_);
    adam_ =
        std::make_unique<Adam>(*network_, AdamOptions{.weight_decay = options.weight_decay,
                                                      .gradient_limit = options.gradient_limit});
  }

  TrainResult Run() {
    if (options_.resume) Resume();
    const TrainingLoss loss(data_.train.camera, options_.loss);
    Loader loader(data_.train, {options_.network, options_.batch, options_.augment, options_.seed},
                  state_.step);
    const std::int64_t every = options_.validate_steps > 0 ? options_.validate_steps : per_epoch_;
    if (!options_.start.empty() && state_.step == 0) Validate();  // it may be the best already
    while (!Finished()) {
      Step(loader.Next(), loss);
      if (state_.step % every == 0) Validate();
    }
    if (state_.curve.empty() || state_.curve.back().step != state_.step) Validate();
    return Finish();
  }

 private:
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

  void Step(const Batch& batch, const TrainingLoss& loss) {
    const Stopwatch step;
    // Dropout's noise follows from the step, so that a resumed training sees the same.
    torch::manual_seed(SubSeed(SubSeed(options_.seed, 3), static_cast<std::uint64_t>(state_.step)));
    network_->train();
    const Losses losses = loss(network_->forward(batch.live, batch.key), batch);
    losses.total.backward();
    rate_ = LearningRate();
    adam_->Step(rate_);
    ++state_.step;
    means_.Add(losses);
    step_seconds_ = step.Seconds();
    Report(progress_, "train", state_.step, ExpectedSteps(),
           fmt::format("loss {:.3f}  valid {:.3f} m", losses.total.item<double>(),
                       state_.curve.empty() ? 0.0 : state_.curve.back().valid_position_m));
  }

  std::int64_t ExpectedSteps() const {
    const double done = Done();
    if (done <= 0) return total_steps_;
    return std::min(total_steps_,
                    static_cast<std::int64_t>(static_cast<double>(state_.step) / done) + 1);
  }

  void Validate() {
    const Stopwatch validation;
    CurvePoint point = means_.Take();
    const PairFigures figures =
        EvaluatePairs(PoseNetwork(Describe({}), network_), data_.valid, data_.quick_valid)
            .Figures();
    point.step = state_.step;
    point.epoch = static_cast<double>(state_.step) / static_cast<double>(per_epoch_);
    point.seconds = Seconds();
    point.learning_rate = rate_;
    point.valid_position_m = figures.position_mean_m;
    point.valid_heading_deg = figures.heading_mean_deg;
    state_.curve.push_back(point);
    ++state_.without_gain;
    if (figures.position_mean_m < state_.best_m) {
      state_.best_m = figures.position_mean_m;
      state_.without_gain = 0;
      PoseNetwork(Describe(figures), network_).Save(options_.out);
    }
    WriteCurve(options_.csv, state_.curve);
    WriteCheckpoint(CheckpointPath(options_), Saved(), *network_, *adam_);
    validation_seconds_ = validation.Seconds();
  }

  ModelInfo Describe(const PairFigures& figures) const {
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
    state_ = ReadCheckpoint(path, ToJson(options_), *network_, *adam_);
  }

  TrainResult Finish() {
    const ModelInfo best = PoseNetwork::Load(options_.out, options_.threads).info();
    std::filesystem::remove(CheckpointPath(options_));
    return {best, state_.step, Seconds(), state_.curve};
  }

  const TrainingData& data_;
  const TrainOptions& options_;
  const Stopwatch& watch_;
  const ProgressSink& progress_;
  const std::int64_t per_epoch_, total_steps_;
  std::shared_ptr<PairNetwork> network_;
  std::unique_ptr<Adam> adam_;
  TrainingState state_;
  LossMeans means_;
  double rate_ = 0, step_seconds_ = 0, validation_seconds_ = 0;
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
