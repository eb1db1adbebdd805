#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "recollect/cnn/train_options.h"
#include "recollect/core/progress.h"
#include "recollect/dataset/lap.h"
#include "recollect/evaluation/artefacts.h"
#include "recollect/evaluation/evaluate.h"
#include "recollect/evaluation/paper_split.h"
#include "recollect/evaluation/run_json.h"

namespace recollect {

// The paper's evaluation as a whole (Forechi et al. 2018, section V), on laps of any data set.
struct PaperOptions {
  std::filesystem::path data;           // where the laps were read from; registration.txt is there
  std::filesystem::path out;            // folder for all that comes of it
  std::filesystem::path page_template;  // html_report.h
  std::filesystem::path published;      // UFES-LAPS, for the paper's own tables; empty: without
  std::string images;                   // "rendered" or "real"; empty: as the laps say themselves
  SplitNames laps;
  wnn::NetworkOptions recogniser = wnn::RecollectNetwork();
  std::string recogniser_name = "recollect";
  double spacing_m = 5;  // between key frames
  bool network = true;   // without: geometry alone, no training
  cnn::TrainOptions train = cnn::TrainOptions::Compact();
  std::filesystem::path model;  // a trained one, instead of training
  std::filesystem::path curve;  // the trainer's CSV of that
  // Between live images. None: 1 m, but all of a lap that was rendered, a spacing of its own apart.
  std::optional<double> live_spacing_m;
  EvaluationOptions evaluation;  // its spacing_m is that
  RunStatistics statistics;
  RunStamp stamp;  // command, seed, and the program's own version
  int threads = 0;
};

// Bytes of the images in the page; with all else it stays below 25 MB.
inline constexpr std::size_t kImageBudget = 20'000'000;

// Does in order what has not been done yet, each step one artefact of `out` (artefacts.h): data,
// map, train, places, localise, images. Then writes the report: run.json (all figures, what is
// given back), report.html, table.txt, CSV and SVG files, and trajectories as TUM and KITTI files.
// Throws Error before any work where the laps cannot be split, have no images, do not say whether
// they are rendered, or the model is missing; and at the end where the page's template is.
nlohmann::json RunPaper(const std::vector<Lap>& laps, const PaperOptions& options,
                        const ProgressSink& progress = {});

// Of a trainer's CSV. Throws Error naming the line that is none of its.
std::vector<cnn::CurvePoint> ReadCurve(const std::filesystem::path& csv);

}  // namespace recollect
