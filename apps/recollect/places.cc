#include <fmt/format.h>

#include <opencv2/core.hpp>

#include "command.h"
#include "commands.h"
#include "recollect/core/error.h"
#include "recollect/core/files.h"
#include "recollect/core/parallel.h"
#include "recollect/dataset/image.h"
#include "recollect/dataset/image_folder.h"
#include "recollect/evaluation/place_trials.h"
#include "recollect/wnn/displaced.h"
#include "recollect/wnn/precision.h"
#include "recollect/wnn/sequence.h"
#include "wnn_flags.h"

namespace recollect::app {
namespace {

struct PlacesFlags {
  Common common;
  std::filesystem::path reference, query, csv;
  wnn::NetworkOptions network = wnn::RecollectNetwork();
  wnn::SequenceOptions sequence{.filter = wnn::Filter::kNone};
  bool support = true;
  int from = 1, tolerance = 3;
};

std::string CurveAsCsv(const wnn::PrecisionCurve& curve) {
  std::string csv = "threshold,precision,recall\n";
  for (const wnn::PrecisionPoint& point : curve.points) {
    csv += fmt::format("{},{},{}\n", point.threshold, point.precision, point.recall);
  }
  return csv;
}

void RunPlaces(PlacesFlags flags) {
  flags.network.seed = flags.common.seed;
  const auto references = ImagesIn(flags.reference).size();
  const auto queries = ImagesIn(flags.query).size();
  Require(references == queries, flags.query.string(),
          fmt::format("{} images where the reference has {}", queries, references),
          "image i of one must show the place of image i of the other");
  Require(flags.from >= 1 && static_cast<std::size_t>(flags.from) <= queries, "--from",
          fmt::format("is not an image of {}", queries));

  ThreadPool pool(flags.common.threads);
  const ProgressSink progress = TerminalProgress();
  const PlaceImages places = ReadPlaces(flags.reference);
  LearntPlaces learnt(places, flags.network, pool);
  wnn::Calibration calibration;
  if (flags.support) {
    calibration =
        wnn::Calibrate(places.route, learnt.Trials(pool, {.seed = flags.common.seed}, progress));
    flags.sequence.votes = calibration.votes;
  }
  const auto sequence = wnn::MakeSequence(flags.sequence, places.route);
  const wnn::SearchOptions search{.tie_seed = flags.common.seed};
  std::vector<int> answers, truths;
  std::vector<double> scores;
  std::vector<bool> right;
  const auto files = ImagesIn(flags.query);
  // The live camera may be another than the one that saw the reference.
  const ImageInfo first = ReadImageInfo(files.front());
  wnn::Encoder encoder(flags.network, first.width, first.height, pool);
  for (std::size_t i = 0; i < files.size(); ++i) {
    const cv::Mat image = ReadColour(files[i]);
    Require(image.cols == first.width && image.rows == first.height, files[i].string(),
            fmt::format("{} x {} pixels where the first of its folder has {} x {}", image.cols,
                        image.rows, first.width, first.height));
    const wnn::ImageView view{image.data, image.cols, image.rows, 3,
                              static_cast<std::ptrdiff_t>(image.step)};
    const wnn::Recollection one = wnn::RecollectImage(learnt.memory, encoder, view, pool, search);
    std::vector<float> distances;
    if (flags.sequence.filter == wnn::Filter::kSabgl) {
      distances = wnn::MeanDistances(learnt.memory, encoder.Encode(view), pool);
    }
    wnn::PlaceBelief answer = wnn::MostLikely(
        places.route, sequence->Update({one.histogram, one.neurons_read, distances, {}}),
        one.histogram);
    if (flags.sequence.filter == wnn::Filter::kNone) {
      const wnn::Judged judged =
          wnn::Judge(calibration, places.route, one.histogram, one.neurons_read);
      answer = flags.support ? wnn::PlaceBelief{judged.place, judged.probability}
                             : wnn::PlaceBelief{one.winner, one.confidence};
    }
    Report(progress, "recollect", static_cast<std::int64_t>(i + 1),
           static_cast<std::int64_t>(files.size()));
    if (static_cast<int>(i) + 1 < flags.from) continue;
    truths.push_back(static_cast<int>(i));
    answers.push_back(answer.place);
    scores.push_back(answer.probability);
    right.push_back(std::abs(answer.place - truths.back()) <= flags.tolerance);
  }

  const std::vector<int> limits = {0, 1, 2, 3, 5, 10};
  const std::vector<double> shares = wnn::SharesWithin(answers, truths, limits);
  const wnn::PrecisionCurve curve = wnn::MakePrecisionCurve(scores, right);
  nlohmann::json figures = {{"images", answers.size()},
                            {"auc", curve.auc},
                            {"recall_at_100_precision", curve.recall_at_100_precision}};
  fmt::print("{} images\nwithin  share\n", answers.size());
  for (std::size_t i = 0; i < limits.size(); ++i) {
    figures["within"][std::to_string(limits[i])] = shares[i];
    fmt::print("{:6}  {:4.1f} %\n", limits[i], 100 * shares[i]);
  }
  fmt::print(
      "right within {}: area under precision over recall {:.3f}, recall without error {:.1f} %\n",
      flags.tolerance, curve.auc, 100 * curve.recall_at_100_precision);
  if (!flags.csv.empty()) AtomicWrite(flags.csv, CurveAsCsv(curve));
  WriteFigures(flags.common, figures);
}

}  // namespace

void AddPlaces(CLI::App& app) {
  auto flags = std::make_shared<PlacesFlags>();
  CLI::App* command =
      AddCommand(app, "places",
                 "Recognise places: two folders of images in the same order, one of them learnt",
                 flags->common, [flags] { RunPlaces(*flags); });
  command->add_option("--reference", flags->reference, "images to learn")
      ->type_name("DIR")
      ->required();
  command->add_option("--query", flags->query, "images to recognise")->type_name("DIR")->required();
  AddSequenceFlags(*command, flags->sequence);
  command
      ->add_flag("--support,!--no-support", flags->support,
                 "neighbouring places lend each other half of their votes, and what votes are "
                 "worth is learnt from the reference; without: the most voted image")
      ->default_str("true");
  command->add_option("--from", flags->from, "judge from the so many-th image on")
      ->capture_default_str();
  command
      ->add_option("--tolerance", flags->tolerance,
                   "frames off that still count as right for precision and recall")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--csv", flags->csv, "write the curve of precision over recall to this file")
      ->type_name("FILE");
  AddWnnFlags(*command, flags->network);
}

}  // namespace recollect::app
