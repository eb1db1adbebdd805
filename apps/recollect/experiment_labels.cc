#include "experiment_labels.h"

#include <fmt/format.h>

#include "command.h"
#include "laps.h"
#include "recollect/core/parallel.h"
#include "recollect/evaluation/place_accuracy.h"
#include "recollect/wnn/committee.h"
#include "wnn_flags.h"

namespace recollect::app {
namespace {

struct LabelsFlags {
  Common common;
  LapFlags laps;
  std::string live;
  double key_spacing = 5, live_spacing = 1;
  wnn::NetworkOptions network;
};

void RunLabels(LabelsFlags flags) {
  flags.network.seed = flags.common.seed;
  ThreadPool pool(flags.common.threads);
  const PlaceTask task =
      PlacesByNearest(flags.laps.Read(), ReadLapRange(flags.live, ParseFormat(flags.laps.format)),
                      flags.key_spacing, flags.live_spacing);
  const std::vector<int> answers = AnswerPlaces(flags.network, task.learnt, task.live,
                                                flags.common.seed, pool, TerminalProgress());
  std::size_t learnt = 0;
  for (const LabelledImages& lap : task.learnt) learnt += lap.images.size();
  std::vector<int> limits;
  for (int k = 0; k <= 10; ++k) limits.push_back(k);
  const std::vector<double> shares = wnn::SharesWithin(answers, task.live.labels, limits);
  nlohmann::json figures = {{"places", task.places}, {"learnt", learnt}, {"live", answers.size()}};
  fmt::print("{} places, {} images learnt, {} live\nwithin  share\n", task.places, learnt,
             answers.size());
  for (std::size_t k = 0; k < limits.size(); ++k) {
    figures["within"][std::to_string(limits[k])] = shares[k];
    fmt::print("{:6}  {:4.1f} %\n", limits[k], 100 * shares[k]);
  }
  WriteFigures(flags.common, figures);
}

}  // namespace

void AddExperimentLabels(CLI::App& experiment) {
  auto flags = std::make_shared<LabelsFlags>();
  CLI::App* command = AddCommand(
      experiment, "labels",
      "Place recognition as in the paper: share of live frames within k places of the right one",
      flags->common, [flags] { RunLabels(*flags); });
  flags->laps.AddTo(*command);
  command->add_option("--live", flags->live, "lap of live frames")->type_name("DIR")->required();
  command->add_option("--key-spacing", flags->key_spacing, "metres between places")
      ->capture_default_str();
  command->add_option("--live-spacing", flags->live_spacing, "metres between live frames")
      ->capture_default_str();
  AddWnnFlags(*command, flags->network);
}

}  // namespace recollect::app
