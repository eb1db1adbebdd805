#include <fmt/format.h>

#include <opencv2/core.hpp>

#include "command.h"
#include "commands.h"
#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/dataset/image.h"
#include "recollect/dataset/image_folder.h"
#include "recollect/wnn/encoder.h"
#include "recollect/wnn/search.h"
#include "wnn_flags.h"

namespace recollect::app {
namespace {

struct PlacesFlags {
  Common common;
  std::filesystem::path reference, query;
  wnn::NetworkOptions network;
};

// Calls use(pattern) for the images of a folder in order. Synapses scale with the first image.
void EncodeFolder(const std::filesystem::path& folder, const wnn::NetworkOptions& options,
                  ThreadPool& pool, const std::string& stage,
                  const std::function<void(std::span<const std::uint64_t>)>& use) {
  const auto files = ImagesIn(folder);
  const ImageInfo first = ReadImageInfo(files.front());
  wnn::Encoder encoder(options, first.width, first.height, pool);
  std::vector<std::uint64_t> pattern(encoder.pattern_words());
  const ProgressSink progress = TerminalProgress();
  for (std::size_t i = 0; i < files.size(); ++i) {
    const cv::Mat image = ReadColour(files[i]);
    Require(image.cols == first.width && image.rows == first.height, files[i].string(),
            fmt::format("{} x {} pixels where the first of its folder has {} x {}", image.cols,
                        image.rows, first.width, first.height));
    encoder.Encode({image.data, image.cols, image.rows, image.channels(),
                    static_cast<std::ptrdiff_t>(image.step)},
                   pattern);
    use(pattern);
    Report(progress, stage, static_cast<std::int64_t>(i + 1),
           static_cast<std::int64_t>(files.size()));
  }
}

void RunPlaces(PlacesFlags flags) {
  flags.network.seed = flags.common.seed;
  const auto references = ImagesIn(flags.reference).size();
  const auto queries = ImagesIn(flags.query).size();
  Require(references == queries, flags.query.string(),
          fmt::format("{} images where the reference has {}", queries, references),
          "image i of one must show the place of image i of the other");

  ThreadPool pool(flags.common.threads);
  wnn::Memory memory(flags.network.neurons());
  EncodeFolder(flags.reference, flags.network, pool, "learn",
               [&](auto pattern) { memory.Append(pattern); });
  std::vector<int> answers, truths;
  EncodeFolder(flags.query, flags.network, pool, "recollect", [&](auto pattern) {
    truths.push_back(static_cast<int>(truths.size()));
    answers.push_back(
        wnn::Recollect(memory, pattern, pool, {.tie_seed = flags.common.seed}).winner);
  });

  const std::vector<int> limits = {0, 1, 2, 3, 5, 10};
  const std::vector<double> shares = wnn::SharesWithin(answers, truths, limits);
  nlohmann::json figures = {{"images", answers.size()}};
  fmt::print("{} images\nwithin  share\n", answers.size());
  for (std::size_t i = 0; i < limits.size(); ++i) {
    figures["within"][std::to_string(limits[i])] = shares[i];
    fmt::print("{:6}  {:4.1f} %\n", limits[i], 100 * shares[i]);
  }
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
  AddWnnFlags(*command, flags->network);
}

}  // namespace recollect::app
