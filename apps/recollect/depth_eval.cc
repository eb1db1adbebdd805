#include <fmt/format.h>

#include <memory>

#include "command.h"
#include "commands.h"
#include "depth_flags.h"
#include "recollect/dataset/reader.h"
#include "recollect/depth/evaluate.h"
#include "recollect/depth/temporal.h"

namespace recollect::app {
namespace {

struct DepthEvalFlags {
  Common common;
  std::filesystem::path lap;
  stereo::MatchOptions options;
  int every = 1;
  bool temporal = false;
};

void RunTemporal(const DepthEvalFlags& flags, ThreadPool& pool) {
  nlohmann::json figures;
  fmt::print("{:<8}{:>10}{:>10}{:>14}\n", "method", "density %", "median %", "median_valid %");
  for (const stereo::TemporalAgreement& a :
       stereo::CompareOverTime(ReadLap(flags.lap), flags.options, pool, TerminalProgress())) {
    fmt::print("{:<8}{:>10.2f}{:>10.3f}{:>14.3f}\n", stereo::MethodName(a.method), 100 * a.density,
               100 * a.median, 100 * a.median_valid);
    figures[std::string(stereo::MethodName(a.method))] = {
        {"density", a.density},
        {"temporal_median", a.median},
        {"temporal_median_valid", a.median_valid}};
  }
  WriteFigures(flags.common, figures);
}

void Run(DepthEvalFlags flags) {
  flags.options.sps.planes.seed = flags.common.seed;
  ThreadPool pool(flags.common.threads);
  if (flags.temporal) return RunTemporal(flags, pool);
  const stereo::DepthEvaluation result = stereo::EvaluateDepth(
      ReadLap(flags.lap), flags.options, flags.every, pool, TerminalProgress());
  nlohmann::json figures = {
      {"frames", result.frames}, {"pixels", result.pixels}, {"visible", result.visible}};
  fmt::print("{} frames, {} pixels with true depth, {:.1f} % of them seen by both cameras\n\n",
             result.frames, result.pixels, 100 * result.visible);
  fmt::print("{:<8}{:>10}{:>9}{:>9}{:>12}{:>12}{:>14}{:>20}{:>8}\n", "method", "density %",
             "bad3 %", "bad1 %", "rel_median", "bad3_valid", "bad3_visible", "bad3_visible_valid",
             "ms");
  for (const auto& [method, e] : result.methods) {
    fmt::print("{:<8}{:>10.2f}{:>9.2f}{:>9.2f}{:>12.4f}{:>12.2f}{:>14.2f}{:>20.2f}{:>8.0f}\n",
               stereo::MethodName(method), 100 * e.density, 100 * e.bad3, 100 * e.bad1,
               e.rel_median, 100 * e.bad3_valid, 100 * e.bad3_visible, 100 * e.bad3_visible_valid,
               e.ms);
    figures[std::string(stereo::MethodName(method))] = {
        {"density", e.density},
        {"bad3", e.bad3},
        {"bad1", e.bad1},
        {"rel_median", e.rel_median},
        {"ms", e.ms},
        {"bad3_valid", e.bad3_valid},
        {"bad3_visible", e.bad3_visible},
        {"bad3_visible_valid", e.bad3_visible_valid}};
  }
  WriteFigures(flags.common, figures);
}

}  // namespace

void AddDepthEval(CLI::App& app) {
  const auto flags = std::make_shared<DepthEvalFlags>();
  CLI::App* command =
      AddCommand(app, "depth-eval", "Errors of depth from stereo beside true depth and a rival",
                 flags->common, [flags] { Run(*flags); });
  command->add_option("--lap", flags->lap, "a lap with right images and true depth")
      ->type_name("DIR")
      ->required();
  command->add_option("--every", flags->every, "only every n-th of its frames that have both")
      ->capture_default_str();
  command->add_flag("--temporal", flags->temporal,
                    "instead of errors: does depth agree from frame to frame? Needs no true depth");
  AddStereoFlags(*command, flags->options);
}

}  // namespace recollect::app
