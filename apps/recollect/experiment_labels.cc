#include "experiment_labels.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

#include "command.h"
#include "laps.h"
#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/dataset/image.h"
#include "recollect/dataset/sampling.h"
#include "recollect/wnn/encoder.h"
#include "recollect/wnn/search.h"
#include "wnn_flags.h"

namespace recollect::app {
namespace {

constexpr double kSquareAngle = 1.5707963267948966;

struct LabelsFlags {
  Common common;
  LapFlags laps;
  std::string live;
  double key_spacing = 5, live_spacing = 1;
  wnn::NetworkOptions network;
};

// The key frame nearest to a frame of another lap, among those that look the same way.
int NearestKeyFrame(const Lap& keys, const Lap& lap, std::size_t frame) {
  const Eigen::Vector3d at = lap.frames[frame].world_from_body.translation();
  double nearest = std::numeric_limits<double>::infinity();
  int label = 0;
  for (std::size_t k = 0; k < keys.frames.size(); ++k) {
    const double distance = (keys.frames[k].world_from_body.translation() - at).norm();
    if (distance >= nearest) continue;
    if (HeadingDifference(Heading(keys, k), Heading(lap, frame)) > kSquareAngle) continue;
    nearest = distance;
    label = static_cast<int>(k);
  }
  return label;
}

std::vector<std::uint64_t> Encode(wnn::Encoder& encoder, const Lap& lap, std::size_t frame) {
  const std::filesystem::path& file = lap.frames[frame].left;
  Require(!file.empty(), lap.name, "holds poses without images");
  const cv::Mat image = ReadColour(file);
  return encoder.Encode({image.data, image.cols, image.rows, image.channels(),
                         static_cast<std::ptrdiff_t>(image.step)});
}

void RunLabels(LabelsFlags flags) {
  flags.network.seed = flags.common.seed;
  std::vector<Lap> laps = flags.laps.Read();
  for (Lap& lap : laps) lap = Subset(lap, SampleFrames(lap, flags.key_spacing));
  const Lap& keys = laps.front();
  const ProgressSink progress = TerminalProgress();
  ThreadPool pool(flags.common.threads);
  const cv::Mat first = ReadColour(keys.frames.front().left);
  wnn::Encoder encoder(flags.network, first.cols, first.rows, pool);
  wnn::Memory memory(flags.network.neurons());
  for (const Lap& lap : laps) {
    for (std::size_t i = 0; i < lap.frames.size(); ++i) {
      const int label = &lap == &keys ? static_cast<int>(i) : NearestKeyFrame(keys, lap, i);
      memory.Append(Encode(encoder, lap, i), label);
      Report(progress, "learn " + lap.name, static_cast<std::int64_t>(i + 1),
             static_cast<std::int64_t>(lap.frames.size()));
    }
  }
  std::vector<int> answers, truths;
  for (Lap live : ReadLapRange(flags.live, ParseFormat(flags.laps.format))) {
    live = Subset(live, SampleFrames(live, flags.live_spacing));
    for (std::size_t i = 0; i < live.frames.size(); ++i) {
      truths.push_back(NearestKeyFrame(keys, live, i));
      answers.push_back(
          wnn::Recollect(memory, Encode(encoder, live, i), pool, {.tie_seed = flags.common.seed})
              .winner);
      Report(progress, "recollect " + live.name, static_cast<std::int64_t>(i + 1),
             static_cast<std::int64_t>(live.frames.size()));
    }
  }
  std::vector<int> limits;
  for (int k = 0; k <= 10; ++k) limits.push_back(k);
  const std::vector<double> shares = wnn::SharesWithin(answers, truths, limits);
  nlohmann::json figures = {
      {"places", keys.frames.size()}, {"learnt", memory.entries()}, {"live", answers.size()}};
  fmt::print("{} places, {} images learnt, {} live\nwithin  share\n", keys.frames.size(),
             memory.entries(), answers.size());
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
