#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <memory>
#include <numbers>
#include <thread>

#include "command.h"
#include "commands.h"
#include "laps.h"
#include "local_ranks.h"
#include "recollect/cnn/trainer.h"

namespace recollect::app {
namespace {

static_assert(std::atomic<bool>::is_always_lock_free);
std::atomic<bool> stop_wanted = false;

// The first Ctrl-C is heard between two steps, the second ends the program as ever.
void HearSignals() {
  struct sigaction action {};
  action.sa_handler = [](int) { stop_wanted = true; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

// Flags that replace a field of the network's preset when they are given.
struct TrainFlags {
  Common common;
  LapFlags laps;
  std::vector<std::string> valid;
  std::string network = "compact";
  std::string schedule, loss;
  int ranks = 1;  // processes to start on this machine
  bool worlds_apart = false, half = false;
  double turn_deg = 0;
  cnn::TrainOptions given;
};

struct TrainCommand {
  TrainFlags flags;
  CLI::App* command = nullptr;

  // The preset of the chosen network, and over it what was given on the command line.
  cnn::TrainOptions Options() const {
    const cnn::NetworkKind kind = cnn::NetworkKindFromName(flags.network);
    cnn::TrainOptions options = kind == cnn::NetworkKind::kCompact ? cnn::TrainOptions::Compact()
                                                                   : cnn::TrainOptions::Paper(kind);
    const cnn::TrainOptions& given = flags.given;
    const auto take = [&](const char* flag, auto& field, const auto& value) {
      if (command->count(flag) > 0) field = value;
    };
    take("--epochs", options.epochs, given.epochs);
    take("--minutes", options.minutes, given.minutes);
    take("--batch", options.batch, given.batch);
    take("--lr", options.learning_rate, given.learning_rate);
    take("--warm-up", options.warm_up_steps, given.warm_up_steps);
    take("--weight-decay", options.weight_decay, given.weight_decay);
    take("--schedule", options.schedule,
         flags.schedule == "cosine" ? cnn::Schedule::kCosine : cnn::Schedule::kHalving);
    take("--augment", options.augment, given.augment);
    options.precision = flags.half ? cnn::Precision::kBfloat16 : cnn::Precision::kFloat32;
    take("--turn", options.view.turn_rad, flags.turn_deg * std::numbers::pi / 180);
    take("--mirror", options.view.mirror, given.view.mirror);
    take("--average", options.average, given.average);
    take("--loss", options.loss.kind,
         flags.loss.empty() ? cnn::LossKind::kProjection : cnn::LossKindFromName(flags.loss));
    take("--beta", options.loss.beta, given.loss.beta);
    take("--far", options.loss.far_metres, given.loss.far_metres);
    take("--correspondence", options.loss.correspondence_weight, given.loss.correspondence_weight);
    take("--depth-loss", options.loss.depth_weight, given.loss.depth_weight);
    take("--distance", options.pairs.max_distance_m, given.pairs.max_distance_m);
    take("--key-spacing", options.pairs.key_spacing_m, given.pairs.key_spacing_m);
    take("--validate-steps", options.validate_steps, given.validate_steps);
    take("--valid-share", options.validation_share, given.validation_share);
    take("--patience", options.patience, given.patience);
    options.seed = flags.common.seed;
    options.threads = flags.common.threads;
    options.device = given.device;
    options.out = given.out;
    options.csv = given.csv;
    options.live = given.live;
    options.stop = [] { return stop_wanted.load(); };
    options.checkpoint = given.checkpoint;
    options.start = given.start;
    options.resume = given.resume;
    return options;
  }

  void Run() const {
    cnn::TrainOptions options = Options();
    if (flags.ranks == 1) {
      options.ranks = cnn::RankOptionsFromEnvironment();
      Train(options);
      return;
    }
    if (options.threads == 0) {  // the cores are shared out
      const int cores = static_cast<int>(std::thread::hardware_concurrency());
      options.threads = std::max(1, cores / flags.ranks);
    }
    RunLocalRanks(flags.ranks, [&](const cnn::RankOptions& ranks) {
      options.ranks = ranks;
      Train(options);
    });
  }

  void Train(const cnn::TrainOptions& options) const {
    HearSignals();
    const bool first = options.ranks.rank == 0;
    const std::vector<Lap> laps = flags.laps.Read(flags.worlds_apart);
    std::vector<Lap> valid;
    for (const std::string& folder : flags.valid) {
      for (Lap& lap : ReadLapRange(folder, ParseFormat(flags.laps.format))) {
        valid.push_back(std::move(lap));
      }
    }
    const cnn::TrainResult result =
        cnn::Train(laps, valid, options, first ? TerminalProgress() : ProgressSink());
    if (!first) return;
    const cnn::PairFigures& figures = result.model.validation;
    fmt::print(
        "{}: network {}, {} parameters, {} steps in {:.0f} s, best at step {}\n"
        "validated on {} ({} pairs)\n"
        "               mean      median\n"
        "position     {:6.3f} m   {:6.3f} m\n"
        "no motion    {:6.3f} m   {:6.3f} m\n"
        "heading      {:6.2f} deg {:6.2f} deg\n",
        options.out.string(), flags.network, result.model.parameters, result.steps, result.seconds,
        result.model.steps, result.model.validated_on, figures.pairs, figures.position_mean_m,
        figures.position_median_m, figures.no_motion_mean_m, figures.no_motion_median_m,
        figures.heading_mean_deg, figures.heading_median_deg);
    nlohmann::json json = nlohmann::json::parse(cnn::ToJson(result.model));
    json["best_step"] = json["steps"];
    json["steps"] = result.steps;
    json["seconds"] = result.seconds;
    WriteFigures(flags.common, json);
  }
};

}  // namespace

void AddTrain(CLI::App& app) {
  auto train = std::make_shared<TrainCommand>();
  TrainFlags& flags = train->flags;
  cnn::TrainOptions& given = flags.given;
  train->command = AddCommand(app, "train", "Train the network that relates two images",
                              flags.common, [train] { train->Run(); });
  CLI::App& command = *train->command;
  flags.laps.AddTo(command);
  command.add_option("--valid", flags.valid, "laps to validate on, live, against those of --lap");
  command.add_option("--out", given.out, "the model file to write")->required();
  command.add_option("--network", flags.network, "a, b or compact")->capture_default_str();
  command.add_option("--minutes", given.minutes, "time limit for all of it");
  command.add_option("--epochs", given.epochs, "times that all pairs are seen");
  command.add_option("--batch", given.batch, "pairs a step");
  command.add_option("--lr", given.learning_rate, "learning rate at the start");
  command.add_option("--schedule", flags.schedule, "how the rate falls: halving or cosine")
      ->check(CLI::IsMember({"halving", "cosine"}));
  command.add_option("--warm-up", given.warm_up_steps, "steps over which the rate rises");
  command.add_option("--weight-decay", given.weight_decay, "decoupled weight decay");
  command.add_flag("--augment,!--no-augment", given.augment, "vary light and colours");
  command.add_flag("--bf16", flags.half,
                   "convolve in bfloat16; networks a and b, on the processor");
  command.add_option("--turn", flags.turn_deg,
                     "turn both cameras at random, up to these degrees about each axis; 0: off");
  command.add_flag("--mirror", given.view.mirror, "see half of the pairs in a mirror");
  command.add_option("--average", given.average,
                     "keep averages of the weights, of which a step leaves this share; 0: off");
  command.add_option("--loss", flags.loss,
                     "projection, reprojection, l2, homoscedastic or uncertainty");
  command.add_option("--beta", given.loss.beta, "of --loss l2: metres that a radian counts as");
  command.add_option("--far", given.loss.far_metres, "points beyond count as being so far; 0: off");
  command.add_option("--correspondence", given.loss.correspondence_weight,
                     "weight of the correspondence loss; 0: off");
  command.add_option("--depth-loss", given.loss.depth_weight, "weight of the depth loss; 0: off");
  command.add_flag("--worlds-apart", flags.worlds_apart,
                   "each --lap is a world of its own: no pairs between them");
  command.add_option("--distance", given.pairs.max_distance_m, "metres between two frames at most");
  command.add_option("--key-spacing", given.pairs.key_spacing_m,
                     "metres between key frames; 0: all frames are key frames");
  command.add_option("--validate-steps", given.validate_steps, "steps between validations");
  command.add_option("--valid-share", given.validation_share,
                     "share of the road to validate on when there is no --valid");
  command.add_option("--patience", given.patience, "validations without gain before the end");
  command.add_option("--csv", given.csv, "file for the curves");
  command.add_option("--live", given.live, "file for the curves as a page that stays up to date");
  command
      .add_option("--ranks", flags.ranks,
                  "processes to train in; on several machines set RANK, WORLD_SIZE, MASTER_ADDR "
                  "and MASTER_PORT instead")
      ->check(CLI::Range(1, 64));
  command.add_option("--device", given.device,
                     "cpu, cuda or cuda:N; without: a graphics card where libtorch sees one");
  command.add_option("--checkpoint", given.checkpoint, "default: OUT.checkpoint");
  command.add_option("--start", given.start, "a model to begin with; without: fresh weights")
      ->check(CLI::ExistingFile);
  command.add_flag("--resume", given.resume, "take up from the checkpoint if there is one");
}

}  // namespace recollect::app
