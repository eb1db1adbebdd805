#include <fmt/format.h>

#include <memory>

#include "command.h"
#include "laps.h"
#include "recognition_commands.h"
#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/evaluation/place_trials.h"

namespace recollect::app {
namespace {

struct AblationFlags {
  Common common;
  LapFlags laps;
  std::vector<std::filesystem::path> images;
  std::string live;
  double spacing_m = 5, live_spacing_m = 1, within_m = 5;
  int seeds = 3, stride = 1;
};

// The share of images whose place is found, by one variant with one seed, on each set in turn.
class Scorer {
 public:
  Scorer(const AblationFlags& flags, ThreadPool& pool) : flags_(flags), pool_(pool) {
    if (!flags.laps.folders.empty()) {
      sets_.push_back(ReadPlaces(flags.laps.Read(), flags.spacing_m));
    }
    for (const auto& folder : flags.images) sets_.push_back(ReadPlaces(folder));
    Require(!sets_.empty(), "--lap", "nothing to learn", "name laps, or folders with --images");
    if (flags.live.empty()) return;
    live_ = ReadLapRange(flags.live, ParseFormat(flags.laps.format));
    Require(live_.size() == 1 && flags.images.empty() && !flags.laps.folders.empty(), "--live",
            "is one lap, beside mapped ones");
  }

  double Score(const wnn::NetworkOptions& network) const {
    if (live_.empty()) {
      double sum = 0;
      for (const PlaceImages& set : sets_) sum += TrialScore(set, network, flags_.stride, pool_);
      return sum / static_cast<double>(sets_.size());
    }
    LearntPlaces learnt(sets_.front(), network, pool_);
    const auto answers = AnswerLive(learnt, live_.front(), flags_.live_spacing_m,
                                    {.filter = wnn::Filter::kNone}, {}, pool_);
    int right = 0;
    for (const PlaceAnswer& answer : answers) right += answer.supported_m <= flags_.within_m;
    return static_cast<double>(right) / static_cast<double>(answers.size());
  }

 private:
  const AblationFlags& flags_;
  ThreadPool& pool_;
  std::vector<PlaceImages> sets_;
  std::vector<Lap> live_;
};

void Run(const AblationFlags& flags) {
  ThreadPool pool(flags.common.threads);
  const Scorer scorer(flags, pool);
  const ProgressSink progress = TerminalProgress();
  const std::vector<Variant> variants = AblationVariants();
  nlohmann::json figures = nlohmann::json::array();
  fmt::print("{:<44}{:>10}{:>10}{:>12}\n", "", "right, %", "+-", "bytes/image");
  for (std::size_t v = 0; v < variants.size(); ++v) {
    std::vector<double> shares;
    for (int s = 0; s < flags.seeds; ++s) {
      wnn::NetworkOptions network = variants[v].network;
      network.seed = flags.common.seed + static_cast<std::uint64_t>(s);
      shares.push_back(scorer.Score(network));
    }
    const Estimate estimate = MeanOf(shares);
    const int bytes = variants[v].network.neurons() * wnn::kWords * 8;
    fmt::print("{:<44}{:>10.1f}{:>10.1f}{:>12}\n", variants[v].name, 100 * estimate.mean,
               100 * estimate.half_width, bytes);
    std::fflush(stdout);
    figures.push_back({{"name", variants[v].name},
                       {"shares", shares},
                       {"mean", estimate.mean},
                       {"half_width", estimate.half_width},
                       {"bytes_an_image", bytes}});
    Report(progress, "variants", static_cast<std::int64_t>(v + 1),
           static_cast<std::int64_t>(variants.size()));
  }
  WriteFigures(flags.common, {{"variants", figures}});
}

void AddFlags(CLI::App& command, AblationFlags& flags) {
  flags.laps.AddTo(command, /*required=*/false);
  command
      .add_option("--images", flags.images,
                  "folder of images along one way, in order, without poses; may be repeated")
      ->type_name("DIR");
  command.add_option("--spacing", flags.spacing_m, "metres between the key frames of a lap")
      ->capture_default_str();
  command.add_option("--seeds", flags.seeds, "how many seeds, from --seed on")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command.add_option("--stride", flags.stride, "take every so many-th image for a trial")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
}

}  // namespace

void AddExperimentAblation(CLI::App& experiment) {
  const auto flags = std::make_shared<AblationFlags>();
  CLI::App* command =
      AddCommand(experiment, "ablation",
                 "Share of places found with each invariance of the weightless network alone, and "
                 "without each",
                 flags->common, [flags] { Run(*flags); });
  AddFlags(*command, *flags);
  command
      ->add_option("--live", flags->live,
                   "lap to find in those of --lap; without it each lap is looked for in the others")
      ->type_name("DIR");
  command->add_option("--live-spacing", flags->live_spacing_m, "metres between live images")
      ->capture_default_str();
  command->add_option("--within", flags->within_m, "metres to the right place, with --live")
      ->capture_default_str();
}

}  // namespace recollect::app
