#include <fmt/format.h>

#include <memory>

#include "command.h"
#include "commands.h"
#include "laps.h"
#include "recollect/cnn/fused_errors.h"
#include "recollect/cnn/second_pass.h"

namespace recollect::app {
namespace {

struct PairsFlags {
  Common common;
  std::filesystem::path model;
  std::vector<std::string> live;
  LapFlags laps;
  cnn::PairOptions pairs;
  int fuse = 0;  // key frames whose answers are fused; 0: none
  bool half = false, second_pass = false;
};

void RunPairs(const PairsFlags& flags) {
  const cnn::PoseNetwork network =
      cnn::PoseNetwork::Load(flags.model, flags.common.threads,
                             flags.half ? cnn::Precision::kBfloat16 : cnn::Precision::kFloat32);
  std::vector<Lap> live;
  for (const std::string& folder : flags.live) {
    for (Lap& lap : ReadLapRange(folder, ParseFormat(flags.laps.format))) {
      live.push_back(std::move(lap));
    }
  }
  ThreadPool pool(flags.common.threads);
  const ProgressSink progress = TerminalProgress();
  const cnn::PairData data =
      cnn::LoadPairs(live, flags.laps.Read(), network.crop(), flags.pairs, pool, progress);
  const cnn::PairFigures figures = cnn::EvaluatePairs(network, data, {}, progress).Figures();
  fmt::print(
      "{} pairs up to {} m apart\n"
      "               mean      median      95 %\n"
      "position     {:6.3f} m   {:6.3f} m   {:6.3f} m\n"
      "no motion    {:6.3f} m   {:6.3f} m\n"
      "heading      {:6.2f} deg {:6.2f} deg {:6.2f} deg\n"
      "no motion    {:6.2f} deg\n",
      figures.pairs, flags.pairs.max_distance_m, figures.position_mean_m, figures.position_median_m,
      figures.position_p95_m, figures.no_motion_mean_m, figures.no_motion_median_m,
      figures.heading_mean_deg, figures.heading_median_deg, figures.heading_p95_deg,
      figures.no_motion_heading_mean_deg);
  if (figures.inside_95) {
    fmt::print("inside the 95 % ellipsoid: {:.1f} % of poses, {:.1f} % of positions\n",
               100 * *figures.inside_95, 100 * *figures.position_inside_95);
  }
  nlohmann::json json = nlohmann::json::parse(cnn::ToJson(figures));
  if (flags.fuse > 0) {
    json["fused"] = nlohmann::json::array();
    fmt::print("nearest key frames   position mean, 95 %     heading 95 %\n");
    for (const cnn::PairErrors& errors :
         cnn::EvaluateNearest(network, data, flags.fuse, progress)) {
      const cnn::PairFigures fused = errors.Figures();
      json["fused"].push_back(nlohmann::json::parse(cnn::ToJson(fused)));
      fmt::print("{:>18}   {:6.3f} m, {:6.3f} m   {:6.2f} deg   ({} live frames)\n",
                 json["fused"].size(), fused.position_mean_m, fused.position_p95_m,
                 fused.heading_p95_deg, fused.pairs);
    }
  }
  if (flags.second_pass) {
    const cnn::PairFigures twice = cnn::EvaluateSecondPass(network, data, progress).Figures();
    json["second_pass"] = nlohmann::json::parse(cnn::ToJson(twice));
    fmt::print(
        "asked again, of the key frame nearest to the first answer\n"
        "position     {:6.3f} m   {:6.3f} m   {:6.3f} m\n"
        "heading      {:6.2f} deg {:6.2f} deg {:6.2f} deg\n",
        twice.position_mean_m, twice.position_median_m, twice.position_p95_m,
        twice.heading_mean_deg, twice.heading_median_deg, twice.heading_p95_deg);
  }
  WriteFigures(flags.common, json);
}

}  // namespace

void AddExperimentPairs(CLI::App& experiment) {
  auto flags = std::make_shared<PairsFlags>();
  CLI::App* command =
      AddCommand(experiment, "pairs", "Errors of a network over all pairs of live and key frames",
                 flags->common, [flags] { RunPairs(*flags); });
  command->add_option("--model", flags->model, "the network")->required();
  command->add_option("--live", flags->live, "laps of live frames")->type_name("DIR")->required();
  flags->laps.AddTo(*command);
  command
      ->add_option("--distance", flags->pairs.max_distance_m, "metres between two frames at most")
      ->capture_default_str();
  command->add_flag("--second-pass", flags->second_pass,
                    "errors also of asking again, of the key frame nearest to the first answer");
  command->add_flag("--bf16", flags->half, "answer in bfloat16");
  command->add_option("--key-spacing", flags->pairs.key_spacing_m,
                      "metres between key frames; 0: all frames are key frames");
  command
      ->add_option(
          "--fuse", flags->fuse,
          "errors also of the answers from the nearest 1, 2, ... so many key frames, fused")
      ->check(CLI::Range(1, 100));
}

}  // namespace recollect::app
