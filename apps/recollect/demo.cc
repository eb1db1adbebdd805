#include <fmt/format.h>

#include <memory>

#include "command.h"
#include "commands.h"
#include "recollect/cnn/trainer.h"
#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/core/stopwatch.h"
#include "recollect/dataset/reader.h"
#include "recollect/evaluation/report.h"
#include "recollect/simulation/simulate.h"

namespace recollect::app {
namespace {

struct Options {
  Common common;
  std::filesystem::path data, out = "demo";
  MapOptions map;
  cnn::TrainOptions train = cnn::TrainOptions::Compact();
  EvaluationOptions evaluation;
};

constexpr const char* kDemoLaps = "1-3";
constexpr double kFineTuning = 0.3;  // of the learning rate that fresh weights start at

// Three drives, weeks apart, around a ring of 400 m.
void RenderRing(const Options& options, const std::filesystem::path& folder) {
  simulation::SimulateOptions simulated;
  simulated.laps = kDemoLaps;
  simulated.out = folder;
  simulated.depth = true;
  simulated.change.strength = 1;
  simulated.seed = options.common.seed;
  simulated.threads = options.common.threads;
  simulation::Simulate(simulated, TerminalProgress());
}

void Run(Options options) {
  const Stopwatch whole;
  const bool rendered = options.data.empty();
  const int stages = rendered ? 5 : 4;
  int stage = 0;
  const auto say = [&](const std::string& what) {
    fmt::print("[{}/{}] {:5.0f} s  {}\n", ++stage, stages, whole.Seconds(), what);
    std::fflush(stdout);
  };
  if (rendered) {
    options.data = options.out / "ring";
    say(fmt::format("render three drives on different days into {}", options.data.string()));
    RenderRing(options, options.data);
  }

  std::vector<Lap> laps = ReadLaps(options.data);
  Require(laps.size() >= 2, options.data.string(), "has one lap only",
          "the demo maps all but the last and localises the last");
  const Lap live = laps.back();
  laps.pop_back();

  ThreadPool pool(options.common.threads);
  const std::filesystem::path map_file = options.out / "demo.map";
  say(fmt::format("map of {} laps, a key frame every {} m", laps.size(), options.map.spacing_m));
  options.map.network.seed = options.common.seed;
  CreateMap(map_file, laps, options.map, pool, TerminalProgress());
  const Map map = Map::Open(map_file);

  if (options.train.minutes <= 0) options.train.minutes = rendered ? 6 : 30;
  say(fmt::format("train the {} network on the same laps, at most {:.0f} minutes{}",
                  cnn::Name(options.train.network), options.train.minutes,
                  options.train.start.empty() ? "" : ", from " + options.train.start.string()));
  if (!options.train.start.empty()) options.train.learning_rate *= kFineTuning;
  options.train.seed = options.common.seed;
  options.train.threads = options.common.threads;
  options.train.out = options.out / "demo.model";
  options.train.csv = options.out / "training.csv";
  cnn::Train(laps, {}, options.train, TerminalProgress());

  say(fmt::format("localise lap {}", live.name));
  Localizer localizer(map, cnn::PoseNetwork::Load(options.train.out, options.common.threads), pool);
  const Evaluation evaluation = Evaluate(localizer, live, options.evaluation, TerminalProgress());

  say(rendered ? "draw and write what came of it (rendered images)\n"
               : "draw and write what came of it\n");
  WriteReport(evaluation, map, options.out);
  fmt::print(
      "{}\nsystem: network of weightless neurons + relative-pose network; oracle: told the "
      "nearest key frame.\nPicture: {}\n",
      FormatTable(evaluation), (options.out / "evaluation.png").string());
  WriteFigures(options.common, ToFigures(evaluation));
}

}  // namespace

void AddDemo(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      AddCommand(app, "demo", "Map all laps but the last, train, localise the last, show it",
                 options->common, [options] { Run(*options); });
  command
      ->add_option("--data", options->data,
                   "folder of laps (docs/data.md); without: three laps of a simulated campus")
      ->type_name("DIR");
  command->add_option("--start", options->train.start, "a model to begin the training with")
      ->type_name("FILE")
      ->check(CLI::ExistingFile);
  command->add_option("--out", options->out, "folder for map, model, picture and figures")
      ->type_name("DIR")
      ->capture_default_str();
  command->add_option("--minutes", options->train.minutes,
                      "bound on the training time; default: 30, or 6 without --data");
  command->add_option("--spacing", options->map.spacing_m, "metres between key frames of a lap")
      ->capture_default_str();
}

}  // namespace recollect::app
