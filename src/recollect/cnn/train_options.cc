#include "recollect/cnn/train_options.h"

#include <array>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "recollect/cnn/checkpoint.h"
#include "recollect/core/error.h"

namespace recollect::cnn {
namespace {

constexpr std::array<std::pair<LossKind, const char*>, 5> kLosses = {
    {{LossKind::kProjection, "projection"},
     {LossKind::kReprojection, "reprojection"},
     {LossKind::kL2, "l2"},
     {LossKind::kHomoscedastic, "homoscedastic"},
     {LossKind::kUncertainty, "uncertainty"}}};

// About each axis; within it a wide image's corner stays in front of the camera.
constexpr double kMostTurned = 20 * std::numbers::pi / 180 + 1e-9;

}  // namespace

std::string Name(LossKind kind) {
  for (const auto& [candidate, name] : kLosses) {
    if (candidate == kind) return name;
  }
  throw Error("loss", "is of no known kind");
}

LossKind LossKindFromName(const std::string& name) {
  for (const auto& [kind, candidate] : kLosses) {
    if (candidate == name) return kind;
  }
  throw Error(
      "loss",
      fmt::format("'{}' is not one of projection, reprojection, l2, homoscedastic, uncertainty",
                  name));
}

TrainOptions TrainOptions::Paper(NetworkKind kind) {
  TrainOptions options;
  options.network = kind;
  return options;
}

TrainOptions TrainOptions::Compact() {
  TrainOptions options;
  options.network = NetworkKind::kCompact;
  options.epochs = 4;
  options.learning_rate = 1e-3;
  options.schedule = Schedule::kCosine;
  options.warm_up_steps = 50;
  options.weight_decay = 1e-2;
  options.gradient_limit = 5;
  options.augment = true;
  options.loss = {.far_metres = 30, .correspondence_weight = 0.3, .depth_weight = 0.3};
  options.validate_steps = 100;
  return options;
}

std::string ToJson(const TrainOptions& o) {
  nlohmann::json json{{"network", Name(o.network)},
                      {"epochs", o.epochs},
                      {"batch", o.batch},
                      {"learning_rate", o.learning_rate},
                      {"schedule", o.schedule == Schedule::kCosine ? "cosine" : "halving"},
                      {"warm_up_steps", o.warm_up_steps},
                      {"weight_decay", o.weight_decay},
                      {"gradient_limit", o.gradient_limit},
                      {"augment", o.augment},
                      {"far_metres", o.loss.far_metres},
                      {"correspondence_weight", o.loss.correspondence_weight},
                      {"depth_weight", o.loss.depth_weight},
                      {"loss", Name(o.loss.kind)},
                      {"beta", o.loss.beta},
                      {"max_distance_m", o.pairs.max_distance_m},
                      {"max_angle_rad", o.pairs.max_angle_rad},
                      {"key_spacing_m", o.pairs.key_spacing_m},
                      {"validate_steps", o.validate_steps},
                      {"validation_pairs", o.validation_pairs},
                      {"patience", o.patience},
                      {"validation_share", o.validation_share},
                      {"start", o.start.string()},
                      {"seed", o.seed}};
  // Named only where they are used, so that earlier checkpoints go on.
  if (o.average > 0) json["average"] = o.average;
  if (o.view.turn_rad > 0) json["turn_rad"] = o.view.turn_rad;
  if (o.view.mirror) json["mirror"] = true;
  if (o.precision == Precision::kBfloat16) json["precision"] = "bfloat16";
  return json.dump();
}

void RequireSensible(const TrainOptions& o) {
  const auto require = [](bool holds, const std::string& option, const std::string& range) {
    Require(holds, option, "must be " + range);
  };
  require(o.epochs > 0, "epochs", "positive");
  require(o.batch > 0, "batch", "positive");
  require(o.minutes >= 0, "minutes", "zero or more");
  require(o.learning_rate > 0, "learning rate", "positive");
  require(o.average >= 0 && o.average < 1, "average", "within [0, 1)");
  require(o.view.turn_rad >= 0 && o.view.turn_rad <= kMostTurned, "turn", "from 0 to 20 degrees");
  require(o.validation_pairs > 0, "validation pairs", "positive");
  require(o.validation_share > 0 && o.validation_share < 1, "validation share", "within (0, 1)");
  require(o.loss.far_metres >= 0 && o.loss.correspondence_weight >= 0 && o.loss.depth_weight >= 0,
          "loss", "zero or more in all its parts");
  Require(o.loss.kind != LossKind::kUncertainty || o.network == NetworkKind::kCompact, "loss",
          fmt::format("'uncertainty' needs a covariance, and network {} predicts none",
                      Name(o.network)),
          "train network compact");
  require(o.loss.beta > 0, "beta", "positive");
  require(o.ranks.ranks >= 1 && o.ranks.rank >= 0 && o.ranks.rank < o.ranks.ranks, "rank",
          "within [0, ranks)");
  require(o.batch % o.ranks.ranks == 0, "batch", "a multiple of the number of ranks");
  require(!o.out.empty(), "out", "the name of a file");
}

std::filesystem::path CheckpointPath(const TrainOptions& options) {
  if (!options.checkpoint.empty()) return options.checkpoint;
  std::filesystem::path path = options.out;
  path += ".checkpoint";
  return path;
}

}  // namespace recollect::cnn
