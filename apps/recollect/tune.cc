#include <fmt/format.h>

#include <memory>

#include "command.h"
#include "laps.h"
#include "recognition_commands.h"
#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/evaluation/place_tuning.h"

namespace recollect::app {
namespace {

struct TuneFlags {
  Common common;
  LapFlags laps;
  std::vector<std::filesystem::path> images;
  double spacing_m = 5;
  int seeds = 3, stride = 1;
};

nlohmann::json ToFigures(const Tuned& tuned) {
  nlohmann::json tried = nlohmann::json::array();
  for (const Tried& one : tuned.tried) {
    tried.push_back({{"about", one.about},
                     {"flags", one.flags},
                     {"shares", one.shares},
                     {"gain", one.gain.mean},
                     {"half_width", one.gain.half_width},
                     {"kept", one.kept}});
  }
  return {{"flags", tuned.flags},
          {"recommended_shares", tuned.start},
          {"shares", tuned.shares},
          {"tried", tried}};
}

void Run(const TuneFlags& flags) {
  ThreadPool pool(flags.common.threads);
  std::vector<PlaceImages> sets;
  if (!flags.laps.folders.empty()) sets.push_back(ReadPlaces(flags.laps.Read(), flags.spacing_m));
  for (const auto& folder : flags.images) sets.push_back(ReadPlaces(folder));
  Require(!sets.empty(), "--lap", "nothing to learn", "name laps, or folders with --images");
  const auto score = [&](const wnn::NetworkOptions& network) {
    double sum = 0;
    for (const PlaceImages& set : sets) sum += TrialScore(set, network, flags.stride, pool);
    return sum / static_cast<double>(sets.size());
  };
  const auto tell = [](const Tried& tried) {
    fmt::print("{:<20}{:<44}{:>9.1f}{:>+9.1f}{:>7.1f}\n", tried.about, tried.flags,
               100 * MeanOf(tried.shares).mean, 100 * tried.gain.mean, 100 * tried.gain.half_width);
    std::fflush(stdout);
  };
  fmt::print("{:<20}{:<44}{:>9}{:>9}{:>7}\n", "about", "flags", "right, %", "gain", "+-");
  const Tuned tuned = Tune(TuneQuestions(), score, flags.seeds, flags.common.seed, tell);
  fmt::print("recommended: {:.1f} % right; chosen here: {:.1f} %\n", 100 * MeanOf(tuned.start).mean,
             100 * MeanOf(tuned.shares).mean);
  fmt::print("{}\n", tuned.flags.empty() ? "keep the recommended configuration"
                                         : "pass to map create: " + tuned.flags);
  WriteFigures(flags.common, ToFigures(tuned));
}

}  // namespace

void AddTune(CLI::App& app) {
  const auto flags = std::make_shared<TuneFlags>();
  CLI::App* command =
      AddCommand(app, "tune",
                 "Choose a configuration of the weightless network on your own mapped laps: each "
                 "is looked for in the others, a single one with changed light and viewpoint",
                 flags->common, [flags] { Run(*flags); });
  flags->laps.AddTo(*command, /*required=*/false);
  command
      ->add_option("--images", flags->images,
                   "folder of images along one way, in order, without poses; may be repeated")
      ->type_name("DIR");
  command->add_option("--spacing", flags->spacing_m, "metres between the key frames of a lap")
      ->capture_default_str();
  command->add_option("--seeds", flags->seeds, "how many seeds, from --seed on")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command->add_option("--stride", flags->stride, "take every so many-th image for a trial")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
}

}  // namespace recollect::app
