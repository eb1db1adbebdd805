#include "recollect/benchmark/pipeline_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "recollect/core/error.h"
#include "recollect/core/stopwatch.h"
#include "recollect/dataset/image.h"
#include "recollect/evaluation/statistics.h"

namespace recollect {

nlohmann::json RunPipelineBench(Localizer& localizer, const Lap& live,
                                const PipelineBenchOptions& options) {
  Require(!live.frames.empty() && !live.frames.front().left.empty(), live.folder.string(),
          "has no images");
  const auto frame = [&](int i) -> const Frame& {
    const auto count = static_cast<std::int64_t>(live.frames.size());
    return live.frames[static_cast<std::size_t>(i * count / options.images)];
  };
  for (int i = 0; i < options.warm_up; ++i) localizer.Localize(ReadColour(frame(0).left));

  std::map<std::string, std::vector<double>> times;
  const std::clock_t cpu_start = std::clock();
  for (int i = 0; i < options.images; ++i) {
    Stopwatch whole;
    const cv::Mat image = ReadColour(frame(i).left);
    times["1 image file"].push_back(whole.Milliseconds());
    const StepTimes ms = localizer.Localize(image).ms;
    times["2 recollect"].push_back(ms.recollect);
    times["3 features"].push_back(ms.features);
    times["4 verify"].push_back(ms.verify);
    times["5 geometry"].push_back(ms.features + ms.verify);
    times["6 key frame"].push_back(ms.key_frame);
    times["7 relate"].push_back(ms.relate);
    times["8 total"].push_back(whole.Milliseconds());
  }
  const double cpu = 1e3 * static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC;
  nlohmann::json figures = {{"images", options.images},
                            {"relative", Name(localizer.relative())},
                            {"key_frames", localizer.map().size()},
                            {"cpu_ms", cpu / options.images}};
  for (const auto& [step, values] : times) {
    figures["steps"][step.substr(2)] = {{"p50", Quantile(values, 0.5)},
                                        {"p99", Quantile(values, 0.99)}};
  }
  return figures;
}

std::string DescribePipelineBench(const nlohmann::json& figures) {
  std::string text =
      fmt::format("{} images, {} key frames, {}\n  step, ms             p50     p99\n",
                  figures["images"].get<int>(), figures["key_frames"].get<int>(),
                  figures["relative"].get<std::string>());
  for (const char* step : {"image file", "recollect", "features", "verify", "geometry", "key frame",
                           "relate", "total"}) {
    const auto& times = figures["steps"][step];
    text += fmt::format("  {:<16}{:8.1f}{:8.1f}\n", step, times["p50"].get<double>(),
                        times["p99"].get<double>());
  }
  return text + fmt::format("  processor time an image, all threads: {:.1f} ms\n",
                            figures["cpu_ms"].get<double>());
}

}  // namespace recollect
