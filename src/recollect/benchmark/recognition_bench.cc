#include "recollect/benchmark/recognition_bench.h"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/core/stopwatch.h"
#include "recollect/dataset/image.h"
#include "recollect/evaluation/statistics.h"
#include "recollect/wnn/displaced.h"

namespace recollect {
namespace {

std::vector<cv::Mat> ImagesOf(const Lap& lap, int count) {
  Require(!lap.frames.empty() && !lap.frames.front().left.empty(), lap.folder.string(),
          "has no images");
  const auto wanted = std::min(lap.frames.size(), static_cast<std::size_t>(std::max(1, count)));
  std::vector<cv::Mat> images;
  for (std::size_t i = 0; i < wanted; ++i) {
    images.push_back(ReadColour(lap.frames[i * lap.frames.size() / wanted].left));
  }
  return images;
}

// The steps of one image, in milliseconds.
struct Steps {
  std::vector<double> encode, total;

  void Time(LearntPlaces& learnt, const cv::Mat& image, ThreadPool& pool) {
    const wnn::ImageView view{image.data, image.cols, image.rows, image.channels(),
                              static_cast<std::ptrdiff_t>(image.step)};
    const Stopwatch encoding;
    const wnn::Grids grids(learnt.encoder);
    if (grids.first.count() > 1) {  // up to the search; the closer look reads the rest on its way
      learnt.encoder.LookDisplaced(view, grids.closer).Every(grids.finer());
    } else {
      learnt.encoder.Encode(view);
    }
    encode.push_back(encoding.Milliseconds());
    const Stopwatch all;
    wnn::RecollectImage(learnt.memory, learnt.encoder, view, pool);
    total.push_back(all.Milliseconds());
  }
};

}  // namespace

nlohmann::json RunRecognitionBench(const PlaceImages& places, const Lap& live,
                                   const RecognitionBenchOptions& options) {
  ThreadPool pool(options.threads);
  wnn::NetworkOptions reference, own = wnn::RecollectNetwork();
  reference.seed = own.seed = options.seed;
  LearntPlaces of_reference(places, reference, pool), of_own(places, own, pool);
  Steps reference_steps, own_steps;
  for (const cv::Mat& image : ImagesOf(live, options.images)) {
    reference_steps.Time(of_reference, image, pool);
    own_steps.Time(of_own, image, pool);
  }
  const auto figures = [](const Steps& steps, const LearntPlaces& learnt) {
    return nlohmann::json{{"encode_ms", Quantile(steps.encode, 0.5)},
                          {"total_ms", Quantile(steps.total, 0.5)},
                          {"map_bytes", 8 * learnt.encoder.pattern_words()}};
  };
  nlohmann::json all = {{"key_frames", places.images.size()},
                        {"vibgl", figures(reference_steps, of_reference)},
                        {"recollect", figures(own_steps, of_own)}};
  const auto ratio = [&all](const char* key) {
    return all["recollect"][key].get<double>() / all["vibgl"][key].get<double>();
  };
  all["ratio"] = {{"time", ratio("total_ms")}, {"map", ratio("map_bytes")}};
  return all;
}

std::string DescribeRecognitionBench(const nlohmann::json& figures) {
  std::string text =
      fmt::format("{} key frames; medians\n{:12}{:>12}{:>12}{:>16}\n",
                  figures["key_frames"].get<int>(), "", "encode, ms", "all, ms", "bytes a frame");
  for (const char* name : {"vibgl", "recollect"}) {
    const auto& own = figures[name];
    text += fmt::format("{:12}{:12.2f}{:12.2f}{:16}\n", name, own["encode_ms"].get<double>(),
                        own["total_ms"].get<double>(), own["map_bytes"].get<int>());
  }
  return text + fmt::format("{:12}{:24.2f}{:16.2f}\n", "ratio",
                            figures["ratio"]["time"].get<double>(),
                            figures["ratio"]["map"].get<double>());
}

}  // namespace recollect
