#include <fmt/format.h>

#include <opencv2/core.hpp>

#include "command.h"
#include "commands.h"
#include "explain_flags.h"
#include "recollect/core/error.h"
#include "recollect/core/files.h"
#include "recollect/core/parallel.h"
#include "recollect/dataset/image.h"
#include "recollect/dataset/image_folder.h"
#include "recollect/evaluation/explanation.h"
#include "recollect/evaluation/place_trials.h"
#include "recollect/wnn/displaced.h"
#include "recollect/wnn/precision.h"
#include "recollect/wnn/sabgl.h"
#include "recollect/wnn/sequence.h"
#include "wnn_flags.h"

namespace recollect::app {
namespace {

struct PlacesFlags {
  Common common;
  std::filesystem::path reference, query, csv;
  wnn::NetworkOptions network = wnn::RecollectNetwork();
  wnn::SequenceOptions sequence{.filter = wnn::Filter::kNone};
  ExplainFlags explain;
  bool support = true;
  int from = 1, tolerance = 3;
  double precision = 0;  // 0: no image is refused
};

std::string CurveAsCsv(const wnn::PrecisionCurve& curve) {
  std::string csv = "threshold,precision,recall\n";
  for (const wnn::PrecisionPoint& point : curve.points) {
    csv += fmt::format("{},{},{}\n", point.threshold, point.precision, point.recall);
  }
  return csv;
}

wnn::ImageView ViewOf(const cv::Mat& image) {
  return {image.data, image.cols, image.rows, 3, static_cast<std::ptrdiff_t>(image.step)};
}

// What is known of one image's place.
struct Answer {
  wnn::PlaceBelief place;   // by the filter asked for
  wnn::PlaceBelief single;  // of the image alone
  wnn::Recollection why;
};

// Answers images one by one, in order.
class Recogniser {
 public:
  Recogniser(PlacesFlags& flags, const PlaceImages& places, ThreadPool& pool)
      : flags_(flags), route_(places.route), pool_(pool), learnt_(places, flags.network, pool) {
    if (flags.support) {
      calibration_ = wnn::Calibrate(
          route_, learnt_.Trials(pool, {.seed = flags.common.seed}, TerminalProgress()));
      flags.sequence.votes = calibration_.sequence;
    }
    sequence_ = wnn::MakeSequence(flags.sequence, route_);
  }

  double Threshold() const {
    return flags_.precision > 0 ? wnn::ThresholdFor(calibration_, flags_.precision) : 0;
  }

  Answer Ask(wnn::Encoder& encoder, const cv::Mat& image) {
    const wnn::ImageView view = ViewOf(image);
    wnn::Recollection one =
        wnn::RecollectImage(learnt_.memory, encoder, view, pool_, {.tie_seed = flags_.common.seed});
    std::vector<float> distances;
    if (flags_.sequence.filter == wnn::Filter::kSabgl) {
      distances = wnn::DisplacedDistances(learnt_.memory, encoder, view, pool_);
    }
    Answer answer;
    answer.single = {one.winner, one.confidence};
    if (flags_.support) {
      const auto judged = wnn::Judge(calibration_, route_, one.histogram, one.neurons_read);
      answer.single = {judged.place, judged.probability};
    }
    answer.place = answer.single;
    if (flags_.sequence.filter != wnn::Filter::kNone) {
      const auto belief = sequence_->Update({one.histogram, one.neurons_read, distances, {}});
      answer.place = wnn::MostLikely(route_, belief, one.histogram);
    }
    answer.why = std::move(one);
    return answer;
  }

  void Draw(wnn::Encoder& encoder, const cv::Mat& image, const Answer& answer,
            const std::string& caption, const std::filesystem::path& to) {
    const wnn::Explanation why = wnn::Explain(learnt_.memory, encoder, ViewOf(image), answer.why,
                                              wnn::RunnerUp(route_, answer.why));
    const auto shown = [&](const wnn::Voters& voters, const std::string& what) {
      if (voters.label < 0) return ExplainedImage{{}, "no " + what};
      return ExplainedImage{learnt_.places.images[static_cast<std::size_t>(voters.label)],
                            fmt::format("{}: {}, {} votes", what, voters.label, voters.votes)};
    };
    WriteExplanation(
        to, DrawExplanation({image, caption}, shown(why.winner, "recollected"),
                            shown(why.runner_up, "runner-up"), why, flags_.network.window_aspect));
  }

 private:
  PlacesFlags& flags_;
  const wnn::Route& route_;
  ThreadPool& pool_;
  LearntPlaces learnt_;
  wnn::Calibration calibration_;
  std::unique_ptr<wnn::Sequence> sequence_;
};

void Check(const PlacesFlags& flags) {
  const auto references = ImagesIn(flags.reference).size();
  const auto queries = ImagesIn(flags.query).size();
  Require(references == queries, flags.query.string(),
          fmt::format("{} images where the reference has {}", queries, references),
          "image i of one must show the place of image i of the other");
  Require(flags.from >= 1 && static_cast<std::size_t>(flags.from) <= queries, "--from",
          fmt::format("is not an image of {}", queries));
  Require(flags.precision == 0 || flags.support, "--precision",
          "needs what votes are worth, which --no-support does not learn");
}

void RunPlaces(PlacesFlags flags) {
  Check(flags);
  flags.network.seed = flags.common.seed;
  ThreadPool pool(flags.common.threads);
  const ProgressSink progress = TerminalProgress();
  const PlaceImages places = ReadPlaces(flags.reference);
  Recogniser recogniser(flags, places, pool);
  const double threshold = recogniser.Threshold();
  std::vector<int> answers, truths;
  std::vector<double> scores;
  std::vector<bool> right;
  int known = 0, known_right = 0;
  nlohmann::json each = nlohmann::json::array();
  const auto files = ImagesIn(flags.query);
  // The live camera may be another than the one that saw the reference.
  const ImageInfo first = ReadImageInfo(files.front());
  wnn::Encoder encoder(flags.network, first.width, first.height, pool);
  for (std::size_t i = 0; i < files.size(); ++i) {
    const cv::Mat image = ReadColour(files[i]);
    Require(image.cols == first.width && image.rows == first.height, files[i].string(),
            fmt::format("{} x {} pixels where the first of its folder has {} x {}", image.cols,
                        image.rows, first.width, first.height));
    const Answer answer = recogniser.Ask(encoder, image);
    if (!flags.explain.to.empty()) {
      recogniser.Draw(
          encoder, image, answer,
          fmt::format("{}, score {:.3f}", files[i].filename().string(), answer.single.probability),
          flags.explain.FileOf(files[i], i, files.size()));
    }
    Report(progress, "recollect", static_cast<std::int64_t>(i + 1),
           static_cast<std::int64_t>(files.size()));
    if (static_cast<int>(i) + 1 < flags.from) continue;
    truths.push_back(static_cast<int>(i));
    answers.push_back(answer.place.place);
    scores.push_back(answer.place.probability);
    right.push_back(std::abs(answer.place.place - truths.back()) <= flags.tolerance);
    const bool recognised = answer.single.probability >= threshold;
    known += recognised;
    known_right += recognised && right.back();
    each.push_back({{"place", answer.place.place},
                    {"probability", answer.single.probability},
                    {"recognised", recognised}});
  }

  const std::vector<int> limits = {0, 1, 2, 3, 5, 10};
  const std::vector<double> shares = wnn::SharesWithin(answers, truths, limits);
  const wnn::PrecisionCurve curve = wnn::MakePrecisionCurve(scores, right);
  nlohmann::json figures = {{"images", answers.size()},
                            {"auc", curve.auc},
                            {"recall_at_100_precision", curve.recall_at_100_precision},
                            {"recognised", known},
                            {"recognised_right", known_right},
                            {"answers", each}};
  fmt::print("{} images\nwithin  share\n", answers.size());
  for (std::size_t i = 0; i < limits.size(); ++i) {
    figures["within"][std::to_string(limits[i])] = shares[i];
    fmt::print("{:6}  {:4.1f} %\n", limits[i], 100 * shares[i]);
  }
  fmt::print(
      "right within {}: area under precision over recall {:.3f}, recall without error {:.1f} %\n",
      flags.tolerance, curve.auc, 100 * curve.recall_at_100_precision);
  if (flags.precision > 0) {
    fmt::print("unknown: {} of {}; right among the others: {} of {}\n",
               static_cast<int>(answers.size()) - known, answers.size(), known_right, known);
  }
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
  AddPrecisionFlag(*command, flags->precision);
  flags->explain.AddTo(*command);
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
