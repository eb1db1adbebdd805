#include "recollect/evaluation/paper.h"

#include <limits>
#include <opencv2/core/version.hpp>

#include "recollect/cnn/pose_network.h"
#include "recollect/cnn/versions.h"
#include "recollect/core/error.h"
#include "recollect/core/files.h"
#include "recollect/core/parallel.h"
#include "recollect/dataset/sampling.h"
#include "recollect/dataset/text_table.h"
#include "recollect/evaluation/data_hash.h"
#include "recollect/evaluation/data_tables.h"
#include "recollect/evaluation/drawings.h"
#include "recollect/evaluation/html_report.h"
#include "recollect/evaluation/report.h"
#include "recollect/evaluation/run_text.h"
#include "recollect/evaluation/thumbnails.h"
#include "recollect/matching/mapped.h"

namespace recollect {
namespace {

using nlohmann::json;

constexpr const char* kMapFile = "recollect.map";
constexpr const char* kModelFile = "recollect.model";
constexpr const char* kRegistrationFile = "registration.txt";

json ToJson(const wnn::NetworkOptions& n) {
  return {n.neurons_x,
          n.neurons_y,
          static_cast<int>(n.code),
          n.window_aspect,
          n.gaussian_synapses,
          n.gaussian_sigma,
          n.blur,
          n.blur_sigma,
          n.blur_size,
          n.seed,
          static_cast<int>(n.cells),
          n.working_width,
          n.contrast_sigma,
          n.gradient_arm,
          n.blur_scales,
          n.shift_x,
          n.shift_y,
          n.shift_step};
}

std::string ImagesOf(const PaperOptions& options, const std::vector<Lap>& laps,
                     const PaperSplit& split) {
  if (IsSimulated(laps[split.test])) {
    Require(options.images.empty() || options.images == "rendered", "--images",
            "these laps were rendered by recollect simulate");
    return "rendered";
  }
  Require(options.images == "rendered" || options.images == "real", "--images",
          "the laps do not say whether they are rendered", "say real or rendered");
  return options.images;
}

// One run: what its steps share.
class Paper {
 public:
  Paper(const std::vector<Lap>& laps, const PaperOptions& options, const ProgressSink& progress)
      : laps_(laps),
        options_(options),
        progress_(progress),
        split_(ChooseSplit(laps, options.laps)),
        how_(options.evaluation),
        images_(ImagesOf(options, laps, split_)),
        stamp_(options.stamp),
        pool_(options.threads) {
    how_.spacing_m = options.live_spacing_m.value_or(IsSimulated(laps[split_.test]) ? 0 : 1);
    for (const Lap& lap : laps) {
      Require(!lap.frames.empty() && !lap.frames.front().left.empty(), lap.folder.string(),
              "holds poses without images");
    }
    if (!options.model.empty()) {
      model_hash_ = HashOfFile(options.model);
      cnn::PoseNetwork::Load(options.model, options.threads);
    }
    stamp_.versions["OpenCV"] = CV_VERSION;
    stamp_.versions["libtorch"] = cnn::TorchVersion();
    stamp_.data_hash = HashOf(laps);
    artefacts_.emplace(options.out, stamp_);
    parts_ = {split_.map, split_.train, split_.valid ? json(*split_.valid) : json(), split_.test};
  }

  json Run() {
    json run = {{"title", Title()},
                {"images", images_},
                {"notes", Notes()},
                {"stamp", recollect::ToJson(stamp_)}};
    run["dataset"] = DataStep();
    run["dataset"]["key_frames"] = MapStep()["key_frames"];
    run["training"] = TrainStep();
    run["places"] = PlacesStep();
    run.update(LocaliseStep());
    WriteReports(run, ImagesStep(run));
    return run;
  }

 private:
  std::string Title() const {
    const auto folder = std::filesystem::absolute(options_.data).lexically_normal();
    const auto name = folder.has_filename() ? folder.filename() : folder.parent_path().filename();
    return fmt::format("{}: {} live", name.string(), laps_[split_.test].name);
  }

  json Notes() const {
    json notes = json::array();
    if (images_ == "rendered") {
      notes.push_back(
          "What holds of rendered images need not hold of photographs: they compare systems "
          "with each other on one world, and prove nothing about the real one.");
    }
    if (split_.of_the_paper) notes.push_back("Splits as in the paper (Forechi et al. 2018).");
    if (how_.every > 1) {
      notes.push_back(
          fmt::format("Of the live images every {}th was localised, each by itself.", how_.every));
    }
    return notes;
  }

  json DataStep() {
    return artefacts_->Step("data", {parts_, options_.published.string()}, [&] {
      json rows = json::array();
      for (std::size_t i = 0; i < laps_.size(); ++i) {
        rows.push_back({{"name", laps_[i].name},
                        {"role", RoleOf(split_, i)},
                        {"frames", laps_[i].frames.size()},
                        {"at_1m", SampleFrames(laps_[i], 1).size()},
                        {"at_5m", SampleFrames(laps_[i], 5).size()},
                        {"length_m", PathLength(laps_[i])}});
      }
      json data = {{"laps", rows},
                   {"spacing_m", options_.spacing_m},
                   {"recogniser", options_.recogniser_name}};
      if (!options_.published.empty()) {
        data["published"] = recollect::ToJson(ComputeDataTables(options_.published));
      }
      return data;
    });
  }

  std::vector<Lap> Those(const std::vector<std::size_t>& numbers) const {
    std::vector<Lap> laps;
    for (const std::size_t number : numbers) laps.push_back(laps_[number]);
    return laps;
  }

  json MapStep() {
    const json inputs = {parts_, options_.spacing_m, ToJson(options_.recogniser)};
    return artefacts_->Step("map", inputs,
                            [&] {
                              MapOptions map;
                              map.spacing_m = options_.spacing_m;
                              map.network = options_.recogniser;
                              map.geometry = matching::LandmarkSource();
                              const auto file = artefacts_->Path(kMapFile);
                              CreateMap(file, Those(split_.map), map, pool_, progress_);
                              matching::CalibrateMap(file, pool_, progress_);
                              return json{{"key_frames", Map::Open(file).size()}};
                            },
                            {kMapFile});
  }

  std::optional<cnn::PoseNetwork> Network() const {
    if (!options_.network) return std::nullopt;
    const auto file = options_.model.empty() ? artefacts_->Path(kModelFile) : options_.model;
    return cnn::PoseNetwork::Load(file, options_.threads);
  }

  json TrainStep() {
    if (!options_.network) return artefacts_->Step("train", nullptr, [] { return json(); });
    if (!options_.model.empty()) {
      const json inputs = {model_hash_, options_.curve.empty() ? "" : HashOfFile(options_.curve)};
      return artefacts_->Step("train", inputs, [&] {
        const auto model = cnn::PoseNetwork::Load(options_.model, options_.threads);
        return TrainingJson(
            model.info(),
            options_.curve.empty() ? std::vector<cnn::CurvePoint>() : ReadCurve(options_.curve),
            /*trained_here=*/false);
      });
    }
    const cnn::TrainOptions& given = options_.train;
    const json inputs = {parts_, cnn::Name(given.network), given.minutes, given.epochs};
    return artefacts_->Step(
        "train", inputs,
        [&] {
          cnn::TrainOptions train = given;
          train.out = artefacts_->Path(kModelFile);
          train.resume = true;
          train.seed = stamp_.seed;
          train.threads = options_.threads;
          const std::vector<Lap> valid = split_.valid ? Those({*split_.valid}) : std::vector<Lap>();
          const cnn::TrainResult result = cnn::Train(Those(split_.train), valid, train, progress_);
          return TrainingJson(result.model, result.curve, /*trained_here=*/true);
        },
        {kModelFile});
  }

  PlaceTask Places(const std::vector<Lap>& mapped) const {
    const auto registration = options_.data / kRegistrationFile;
    const Lap& live = laps_[split_.test];
    if (split_.of_the_paper && std::filesystem::exists(registration)) {
      return PlacesByRegistration(ReadRegistration(registration), mapped, live);
    }
    return PlacesByNearest(mapped, std::span(&live, 1), options_.spacing_m, how_.spacing_m);
  }

  // Accuracy when one lap was learnt, and when all were (Forechi et al. 2018, figure 4).
  json PlacesStep() {
    const json inputs = {parts_, ToJson(options_.recogniser), options_.spacing_m,
                         options_.statistics.segment_m, how_.spacing_m};
    return artefacts_->Step("places", inputs, [&] {
      const std::vector<Lap> mapped = Those(split_.map);
      const PlaceTask task = Places(mapped);
      json systems = json::array();
      for (const std::size_t laps : {std::size_t{1}, mapped.size()}) {
        if (laps == 1 && mapped.size() == 1 && !systems.empty()) continue;
        const std::span learnt = std::span(task.learnt).first(laps);
        std::size_t images = 0;
        for (const LabelledImages& lap : learnt) images += lap.images.size();
        const std::vector<int> answers =
            AnswerPlaces(options_.recogniser, learnt, task.live, stamp_.seed, pool_, progress_);
        const std::string name =
            laps == 1 ? "one lap (" + mapped.front().name + ")" : fmt::format("all {} laps", laps);
        systems.push_back(AccuracyJson(name, task, images, answers, options_.statistics));
      }
      return json{{"count", task.places}, {"spacing_m", options_.spacing_m}, {"systems", systems}};
    });
  }

  json LocaliseStep() {
    const json inputs = {artefacts_->Key("map"), artefacts_->Key("train"), how_.spacing_m,
                         how_.every, options_.statistics.segment_m};
    return artefacts_->Step(
        "localise", inputs,
        [&] {
          const Map map = Map::Open(artefacts_->Path(kMapFile));
          LocalizerOptions localizer_options;
          // Steps of several metres are no drive: each image by itself then.
          if (how_.every == 1) localizer_options.sequence.emplace();
          Localizer localizer(map, Network(), pool_, localizer_options);
          const Evaluation evaluation = Evaluate(localizer, laps_[split_.test], how_, progress_);
          WriteTrajectories(evaluation, options_.out);
          WriteFramesCsv(evaluation, artefacts_->Path("frames.csv"));
          return EvaluationJson(evaluation, map, how_, options_.statistics);
        },
        {"frames.csv", "estimate.tum", "estimate.kitti", "truth.tum", "truth.kitti"});
  }

  json ImagesStep(const json& run) {
    return artefacts_->Step("images", {artefacts_->Key("localise")}, [&] {
      const Map map = Map::Open(artefacts_->Path(kMapFile));
      std::vector<std::filesystem::path> live;
      for (const json& frame : run["frames"]["frame"]) {
        live.push_back(laps_[split_.test].frames[frame.get<std::size_t>()].left);
      }
      auto keys = run["frames"]["key_frame"].get<std::vector<int>>();
      for (const json& key : run["frames"]["nearest_key_frame"]) keys.push_back(key);
      return ReportImages(live, keys, map, kImageBudget, progress_);
    });
  }

  void WriteReports(const json& run, const json& images) const {
    AtomicWrite(artefacts_->Path("run.json"), run.dump() + "\n");
    AtomicWrite(artefacts_->Path("table.txt"), FormatRun(run));
    WriteRunCsv(run, options_.out);
    DrawRun(run, options_.out);
    WriteHtmlReport(run, images, options_.page_template, artefacts_->Path("report.html"));
  }

  const std::vector<Lap>& laps_;
  const PaperOptions& options_;
  const ProgressSink& progress_;
  const PaperSplit split_;
  EvaluationOptions how_;
  const std::string images_;
  RunStamp stamp_;
  ThreadPool pool_;
  std::optional<Artefacts> artefacts_;
  std::string model_hash_;
  json parts_;  // the split, as an input of steps
};

}  // namespace

json RunPaper(const std::vector<Lap>& laps, const PaperOptions& options,
              const ProgressSink& progress) {
  return Paper(laps, options, progress).Run();
}

std::vector<cnn::CurvePoint> ReadCurve(const std::filesystem::path& csv) {
  const TextTable table(csv, ',');
  Require(!table.rows().empty(), csv.string(), "is empty");
  const auto& names = table.rows().front().fields;
  const auto column = [&](std::string_view name) {
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  for (const char* name : {"step", "loss", "valid_position_m"}) {
    Require(column(name) < names.size(), csv.string(), fmt::format("has no column '{}'", name),
            "name the file that recollect train --csv wrote");
  }
  std::vector<cnn::CurvePoint> curve;
  for (const TextTable::Row& row : std::span(table.rows()).subspan(1)) {
    table.RequireFields(row, names.size(), "as many fields as the first line");
    cnn::CurvePoint& point = curve.emplace_back();
    point.step = static_cast<std::int64_t>(table.Number(row, column("step")));
    point.loss = table.Number(row, column("loss"));
    point.valid_position_m = table.Number(row, column("valid_position_m"));
    const std::size_t train = column("train_position_m");
    point.train_position_m =
        train < names.size() ? table.Number(row, train) : std::numeric_limits<double>::quiet_NaN();
  }
  return curve;
}

}  // namespace recollect
