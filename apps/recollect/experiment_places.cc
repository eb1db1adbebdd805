#include <fmt/format.h>

#include <array>
#include <memory>

#include "command.h"
#include "laps.h"
#include "recognition_commands.h"
#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/dataset/image.h"
#include "recollect/dataset/image_folder.h"
#include "recollect/evaluation/place_trials.h"
#include "recollect/wnn/displaced.h"
#include "recollect/wnn/precision.h"
#include "wnn_flags.h"

#include <opencv2/imgproc.hpp>

namespace recollect::app {
namespace {

struct PlaceFlags {
  Common common;
  LapFlags laps;
  std::string live;
  std::vector<std::filesystem::path> strangers;
  double spacing_m = 5, live_spacing_m = 1, within_m = 5, precision = 0.99;
  int from = 20;
  wnn::NetworkOptions network = wnn::RecollectNetwork();
  wnn::SequenceOptions sequence{.history = 0};
};

double Share(const std::vector<PlaceAnswer>& answers, double PlaceAnswer::*error, double within,
             int from = 1) {
  int right = 0, all = 0;
  for (std::size_t i = static_cast<std::size_t>(from - 1); i < answers.size(); ++i, ++all) {
    right += answers[i].*error <= within;
  }
  return all == 0 ? 0 : static_cast<double>(right) / all;
}

nlohmann::json BinsToJson(const std::vector<ReliabilityBin>& bins) {
  nlohmann::json array = nlohmann::json::array();
  for (const ReliabilityBin& bin : bins) {
    array.push_back({{"images", bin.count},
                     {"said", bin.said},
                     {"right", bin.right},
                     {"right_95", {bin.low, bin.high}}});
  }
  return array;
}

// Whether of places told with probability p a share p is right, from the `from`-th image on.
nlohmann::json Reliability(const std::vector<PlaceAnswer>& answers, Told PlaceAnswer::*of,
                           int from = 1) {
  std::vector<Told> told;
  for (std::size_t i = static_cast<std::size_t>(from - 1); i < answers.size(); ++i) {
    told.push_back(answers[i].*of);
  }
  return {{"bins", BinsToJson(BinsOfEqualWidth(told))},
          {"deciles", BinsToJson(BinsOfEqualCount(told))}};
}

// How many images of other places are taken for one of the map's, at a threshold.
std::pair<int, int> Accepted(const PlaceFlags& flags, LearntPlaces& learnt,
                             const wnn::Calibration& calibration, double threshold,
                             ThreadPool& pool) {
  int accepted = 0, all = 0;
  const cv::Size size = learnt.places.images.front().size();
  for (const auto& folder : flags.strangers) {
    for (const auto& file : ImagesIn(folder)) {
      cv::Mat image = ReadColour(file);
      cv::resize(image, image, size, 0, 0, cv::INTER_AREA);
      const wnn::Recollection one = wnn::RecollectImage(
          learnt.memory, learnt.encoder,
          {image.data, image.cols, image.rows, 3, static_cast<std::ptrdiff_t>(image.step)}, pool);
      const auto judged =
          wnn::Judge(calibration, learnt.places.route, one.histogram, one.neurons_read);
      accepted += judged.probability >= threshold;
      ++all;
    }
  }
  return {accepted, all};
}

void Run(PlaceFlags flags) {
  flags.network.seed = flags.common.seed;
  ThreadPool pool(flags.common.threads);
  const ProgressSink progress = TerminalProgress();
  const PlaceImages places = ReadPlaces(flags.laps.Read(), flags.spacing_m);
  const std::vector<Lap> live = ReadLapRange(flags.live, ParseFormat(flags.laps.format));
  Require(live.size() == 1, "--live", "is one lap");
  LearntPlaces learnt(places, flags.network, pool);
  const wnn::Calibration calibration =
      wnn::Calibrate(places.route, learnt.Trials(pool, {.seed = flags.common.seed}, progress));
  flags.sequence.votes = calibration.sequence;
  const auto answers = AnswerLive(learnt, live.front(), flags.live_spacing_m, flags.sequence,
                                  calibration, pool, progress);
  Require(static_cast<std::size_t>(flags.from) <= answers.size(), "--from",
          fmt::format("is not one of {} images", answers.size()));

  const double threshold = wnn::ThresholdFor(calibration, flags.precision);
  std::vector<double> scores;
  std::vector<bool> right;
  int good = 0, kept_good = 0, kept = 0;
  for (const PlaceAnswer& answer : answers) {
    const bool keeps = answer.single.probability >= threshold;
    scores.push_back(answer.single.probability);
    right.push_back(answer.single.right);
    good += answer.single.right;
    kept += keeps;
    kept_good += answer.single.right && keeps;
  }
  const wnn::PrecisionCurve curve = wnn::MakePrecisionCurve(scores, right);
  const auto [accepted, strangers] = Accepted(flags, learnt, calibration, threshold, pool);
  nlohmann::json figures = {
      {"key_frames", places.images.size()},
      {"images", answers.size()},
      {"single_by_votes", Share(answers, &PlaceAnswer::single_m, flags.within_m)},
      {"single", Share(answers, &PlaceAnswer::supported_m, flags.within_m)},
      {"single_within_10_m", Share(answers, &PlaceAnswer::supported_m, 10)},
      {"filter", Share(answers, &PlaceAnswer::filtered_m, flags.within_m, flags.from)},
      {"filter_within_10_m", Share(answers, &PlaceAnswer::filtered_m, 10, flags.from)},
      {"auc", curve.auc},
      {"recall_at_100_precision", curve.recall_at_100_precision},
      {"calibration",
       {{"right", calibration.right},
        {"here", calibration.here},
        {"sequence_trust", calibration.sequence.trust},
        {"sequence_sharpness", calibration.sequence.sharpness},
        {"threshold", threshold}}},
      {"reliability", Reliability(answers, &PlaceAnswer::single)},
      {"kept", kept},
      {"kept_right", kept_good},
      {"right", good},
      {"strangers", strangers},
      {"strangers_accepted", accepted}};
  if (flags.sequence.filter != wnn::Filter::kSabgl) {  // whose beliefs are votes
    figures["filter_reliability"] = Reliability(answers, &PlaceAnswer::filtered, flags.from);
  }
  fmt::print("{}\n", figures.dump(2));
  WriteFigures(flags.common, figures);
}

}  // namespace

void AddExperimentPlaces(CLI::App& experiment) {
  const auto flags = std::make_shared<PlaceFlags>();
  CLI::App* command = AddCommand(experiment, "places",
                                 "Find the places of a live lap in mapped ones: single images, "
                                 "filter, calibration, refusal of images from elsewhere",
                                 flags->common, [flags] { Run(*flags); });
  flags->laps.AddTo(*command);
  command->add_option("--live", flags->live, "the live lap")->type_name("DIR")->required();
  command->add_option("--strangers", flags->strangers, "folders of images from elsewhere")
      ->type_name("DIR");
  command->add_option("--spacing", flags->spacing_m, "metres between key frames of a lap")
      ->capture_default_str();
  command->add_option("--live-spacing", flags->live_spacing_m, "metres between live images")
      ->capture_default_str();
  command->add_option("--within", flags->within_m, "metres to the right place")
      ->capture_default_str();
  command->add_option("--precision", flags->precision, "wanted of answers that are not refused")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--from", flags->from, "judge the filter from the so many-th image on")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  AddSequenceFlags(*command, flags->sequence);
  AddWnnFlags(*command, flags->network);
}

}  // namespace recollect::app
