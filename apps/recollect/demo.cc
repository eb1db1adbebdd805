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

namespace recollect::app {
namespace {

struct Options {
  Common common;
  std::filesystem::path data, out = "demo";
  MapOptions map;
  cnn::TrainOptions train = cnn::TrainOptions::Compact();
  EvaluationOptions evaluation;
};

constexpr const char* kHowToGetData =
    "name a folder with two or more laps of one route: make demo DATA=folder. A lap is a folder in "
    "KITTI's style: image_2/, depth/, poses.txt, times.txt, calib.txt (see docs/data.md)";

void Run(Options options) {
  Require(!options.data.empty(), "demo", "no data to show", kHowToGetData);
  const Stopwatch whole;
  int stage = 0;
  const auto say = [&](const std::string& what) {
    fmt::print("[{}/4] {:5.0f} s  {}\n", ++stage, whole.Seconds(), what);
    std::fflush(stdout);
  };

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

  say(fmt::format("train the {} network on the same laps, at most {:.0f} minutes",
                  cnn::Name(options.train.network), options.train.minutes));
  options.train.seed = options.common.seed;
  options.train.threads = options.common.threads;
  options.train.out = options.out / "demo.model";
  options.train.csv = options.out / "training.csv";
  cnn::Train(laps, {}, options.train, TerminalProgress());

  say(fmt::format("localise lap {}", live.name));
  Localizer localizer(map, cnn::PoseNetwork::Load(options.train.out, options.common.threads), pool);
  const Evaluation evaluation = Evaluate(localizer, live, options.evaluation, TerminalProgress());

  say("draw and write what came of it\n");
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
  options->train.minutes = 30;
  CLI::App* command = AddCommand(
      app, "demo", "Map all laps of a folder but the last, train, localise the last, show it",
      options->common, [options] { Run(*options); });
  command->add_option("--data", options->data, "folder of laps")->type_name("DIR");
  command->add_option("--out", options->out, "folder for map, model, picture and figures")
      ->type_name("DIR")
      ->capture_default_str();
  command->add_option("--minutes", options->train.minutes, "bound on the training time")
      ->capture_default_str();
  command->add_option("--spacing", options->map.spacing_m, "metres between key frames of a lap")
      ->capture_default_str();
}

}  // namespace recollect::app
