#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "commands.h"
#include "laps.h"
#include "localizer_flags.h"
#include "recollect/benchmark/cnn_bench.h"
#include "recollect/benchmark/features_bench.h"
#include "recollect/benchmark/pipeline_bench.h"
#include "recollect/benchmark/recognition_bench.h"
#include "recollect/benchmark/search_bench.h"
#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "wnn_flags.h"

namespace recollect::app {
namespace {

struct BenchFlags {
  Common common;
  LapFlags laps;
  std::vector<std::string> live;
  SearchBenchOptions options;
};

void RunSearch(BenchFlags flags) {
  SearchBenchOptions& options = flags.options;
  options.threads = flags.common.threads;
  options.corpus.seed = options.corpus.network.seed = flags.common.seed;
  if (!flags.laps.folders.empty()) options.laps = flags.laps.Read();
  if (!flags.live.empty()) {
    flags.laps.folders = flags.live;
    options.live_laps = flags.laps.Read();
  }
  const nlohmann::json figures = RunSearchBench(options, TerminalProgress());
  fmt::print("{}", DescribeSearchBench(figures));
  WriteFigures(flags.common, figures);
}

struct PipelineFlags {
  Common common;
  LapFlags laps;
  LocalizerFlags localizer;
  PipelineBenchOptions options;
};

void RunPipeline(const PipelineFlags& flags) {
  const std::vector<Lap> laps = flags.laps.Read();
  Require(laps.size() == 1, "--lap", fmt::format("{} laps where one is localised", laps.size()));
  ThreadPool pool(flags.common.threads);
  const Map map = Map::Open(flags.localizer.map);
  Localizer localizer(map, flags.localizer.Network(flags.common.threads), pool,
                      flags.localizer.Options());
  const nlohmann::json figures = RunPipelineBench(localizer, laps.front(), flags.options);
  fmt::print("{}", DescribePipelineBench(figures));
  WriteFigures(flags.common, figures);
}

void AddPipeline(CLI::App& bench) {
  const auto flags = std::make_shared<PipelineFlags>();
  CLI::App* command = AddCommand(bench, "pipeline", "Every step from an image file to its pose",
                                 flags->common, [flags] { RunPipeline(*flags); });
  flags->localizer.AddTo(*command);
  flags->laps.AddTo(*command);
  command->add_option("--images", flags->options.images, "so many, evenly spread over the lap")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
}

struct FeaturesFlags {
  Common common;
  LapFlags laps;
  FeaturesBenchOptions options;
};

void AddFeatures(CLI::App& bench) {
  const auto flags = std::make_shared<FeaturesFlags>();
  CLI::App* command =
      AddCommand(bench, "features", "Features and matching, beside OpenCV, on one thread",
                 flags->common, [flags] {
                   const std::vector<Lap> laps = flags->laps.Read();
                   Require(laps.size() == 1, "--lap",
                           fmt::format("{} laps where one is looked at", laps.size()));
                   const nlohmann::json figures = RunFeaturesBench(laps.front(), flags->options);
                   fmt::print("{}", DescribeFeaturesBench(figures));
                   WriteFigures(flags->common, figures);
                 });
  flags->laps.AddTo(*command);
  command->add_option("--images", flags->options.images, "so many, evenly spread over the lap")
      ->check(CLI::Range(2, 1'000'000))
      ->capture_default_str();
}

struct RecognitionFlags {
  Common common;
  LapFlags laps;
  std::string live;
  double spacing_m = 5;
  RecognitionBenchOptions options;
};

void RunRecognition(RecognitionFlags flags) {
  flags.options.threads = flags.common.threads;
  flags.options.seed = flags.common.seed;
  const std::vector<Lap> live = ReadLapRange(flags.live, ParseFormat(flags.laps.format));
  Require(live.size() == 1, "--live", "is one lap");
  const nlohmann::json figures = RunRecognitionBench(ReadPlaces(flags.laps.Read(), flags.spacing_m),
                                                     live.front(), flags.options);
  fmt::print("{}", DescribeRecognitionBench(figures));
  WriteFigures(flags.common, figures);
}

void AddRecognition(CLI::App& bench) {
  const auto flags = std::make_shared<RecognitionFlags>();
  CLI::App* command = AddCommand(bench, "recognition",
                                 "Both configurations of the weightless network, side by side",
                                 flags->common, [flags] { RunRecognition(*flags); });
  flags->laps.AddTo(*command);
  command->add_option("--live", flags->live, "the live lap")->type_name("DIR")->required();
  command->add_option("--spacing", flags->spacing_m, "metres between key frames of a lap")
      ->capture_default_str();
  command->add_option("--images", flags->options.images, "so many, evenly spread over the live lap")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
}

struct CnnFlags {
  Common common;
  CnnBenchOptions options;
};

void RunCnn(CnnFlags flags) {
  flags.options.threads = flags.common.threads;
  flags.options.seed = flags.common.seed;
  const nlohmann::json figures = RunCnnBench(flags.options, TerminalProgress());
  fmt::print("{}", DescribeCnnBench(figures));
  WriteFigures(flags.common, figures);
}

void AddCnn(CLI::App& bench) {
  const auto flags = std::make_shared<CnnFlags>();
  CLI::App* command = AddCommand(bench, "cnn", "Training and asking the networks, beside libtorch",
                                 flags->common, [flags] { RunCnn(*flags); });
  const auto add = [&](const char* name, int& field, const char* what) {
    command->add_option(name, field, what)->check(CLI::PositiveNumber)->capture_default_str();
  };
  add("--batch", flags->options.batch, "pairs a training step");
  add("--steps", flags->options.steps, "training steps measured");
  add("--questions", flags->options.questions, "pairs asked one after the other");
  add("--checks", flags->options.checks, "pairs whose answers are compared");
}

}  // namespace

void AddBench(CLI::App& app) {
  CLI::App* bench = app.add_subcommand("bench", "Measure speed, side by side in one run");
  bench->require_subcommand(1);
  const auto flags = std::make_shared<BenchFlags>();
  SearchBenchOptions& options = flags->options;
  CLI::App* search = AddCommand(*bench, "search", "Search of the map: every kind on the same map",
                                flags->common, [flags] { RunSearch(*flags); });
  flags->laps.AddTo(*search, false);
  search
      ->add_option("--live", flags->live,
                   "laps to look up; without: the frames of --lap between its key frames")
      ->type_name("DIR");
  search->add_option("--frames", options.corpus.frames, "key frames in the map")
      ->check(CLI::Range(1, 10'000'000))
      ->capture_default_str();
  search->add_option("--spacing", options.corpus.spacing_m, "metres between a lap's key frames")
      ->capture_default_str();
  search->add_option("--checks", options.checks, "images on which early stops are checked")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  search->add_option("--rounds", options.rounds, "measurements of each kind")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  search->add_option("--error-bound", options.error_bound, "of the anytime search")
      ->check(CLI::Range(1e-12, 0.5))
      ->capture_default_str();
  search->add_option("--ranks", options.ranks, "also search over so many processes")
      ->check(CLI::Range(0, 64))
      ->capture_default_str();
  search->add_option("--row-limit", options.row_limit, "of Fat-Fast: entries a row; 0: all")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  search
      ->add_option("--medoids", options.medoids,
                   "measure a memory compressed to so many patterns a neuron, too; 0: not")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  search->add_flag("--fatfast,!--no-fatfast", options.fat_fast, "measure Fat-Fast VG-RAM, too");
  search->add_flag("--plain,!--no-plain", options.plain, "measure the plain kernel, too");
  search->add_flag("--faiss,!--no-faiss", options.faiss, "measure FAISS, too");
  AddWnnFlags(*search, options.corpus.network);
  AddPipeline(*bench);
  AddFeatures(*bench);
  AddRecognition(*bench);
  AddCnn(*bench);
}

}  // namespace recollect::app
