#include "recollect/evaluation/evaluate.h"

#include <fmt/format.h>

#include <memory>

#include "command.h"
#include "commands.h"
#include "laps.h"
#include "localizer_flags.h"
#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/evaluation/report.h"
#include "recollect/simulation/faults.h"

namespace recollect::app {
namespace {

struct Options {
  Common common;
  LocalizerFlags localizer;
  std::filesystem::path out;
  LapFlags laps;
  EvaluationOptions evaluation;
  std::string faults = "none";
};

void Run(const Options& options) {
  const std::vector<Lap> laps = options.laps.Read();
  Require(laps.size() == 1, "--lap", fmt::format("{} laps where one is judged", laps.size()));
  ThreadPool pool(options.common.threads);
  const Map map = Map::Open(options.localizer.map);
  Localizer localizer(map, options.localizer.Network(options.common.threads), pool,
                      options.localizer.Options());
  EvaluationOptions evaluated = options.evaluation;
  simulation::FaultyCamera camera(simulation::ParseFaults(options.faults), options.common.seed);
  if (options.faults != "none") {
    evaluated.spoil = [&camera](cv::Mat& image) { return camera.Take(image); };
  }
  const Evaluation evaluation = Evaluate(localizer, laps.front(), evaluated, TerminalProgress());
  fmt::print("{}", FormatTable(evaluation));
  WriteFigures(options.common, ToFigures(evaluation));
  if (!options.out.empty()) WriteReport(evaluation, map, options.out);
}

}  // namespace

void AddEvaluate(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      AddCommand(app, "evaluate", "Localise a lap and judge the answers beside their baselines",
                 options->common, [options] { Run(*options); });
  options->localizer.AddTo(*command);
  options->laps.AddTo(*command);
  command->add_option("--spacing", options->evaluation.spacing_m, "metres between live images")
      ->capture_default_str();
  command
      ->add_option("--leave-out", options->evaluation.leave_out,
                   "of a lap that is in the map: nothing, its key frames, or also the frames\n"
                   "that their landmarks were made of (none, key-frames, sources)")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, LeaveOut>{{"none", LeaveOut::kNone},
                                          {"key-frames", LeaveOut::kKeyFrames},
                                          {"sources", LeaveOut::kSources}}))
      ->default_str("none");
  command
      ->add_option(
          "--faults", options->faults,
          "spoil live images as such a camera would: none, all, or kinds with their share\n"
          "of the images, as in black=0.1,frozen (frozen, black, overexposed, occluded,\n"
          "blurred)")
      ->capture_default_str();
  command
      ->add_option("--out", options->out,
                   "folder for the picture, the table, the figures and the trajectories")
      ->type_name("DIR");
}

}  // namespace recollect::app
