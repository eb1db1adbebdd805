#include "recollect/simulation/simulate.h"

#include <fmt/format.h>

#include "command.h"
#include "commands.h"

namespace recollect::app {
namespace {

struct SimulateFlags {
  Common common;
  simulation::SimulateOptions options;
  std::string weather = "day";
  std::vector<std::string> fixed;
};

void RunSimulate(SimulateFlags flags) {
  simulation::SimulateOptions& o = flags.options;
  o.seed = flags.common.seed;
  o.threads = flags.common.threads;
  o.weather = simulation::ParseWeather(flags.weather);
  for (const std::string& kind : flags.fixed) {
    if (kind == "light") o.change.light = false;
    if (kind == "structures") o.change.structures = false;
    if (kind == "traffic") o.change.traffic = false;
    if (kind == "season") o.change.season = false;
  }
  const simulation::SimulateResult result = Simulate(o, TerminalProgress());

  nlohmann::json figures = {
      {"rendered", result.rendered}, {"kept", result.kept}, {"seconds", result.seconds}};
  fmt::print("lap  frames  weather   sun\n");
  for (const auto& lap : result.laps) {
    fmt::print(" {:02}  {:6}  {:8}  {:3.0f} degrees\n", lap.number, lap.frames, lap.weather,
               lap.sun_elevation);
    figures["laps"].push_back({{"number", lap.number},
                               {"frames", lap.frames},
                               {"weather", lap.weather},
                               {"sun_elevation_deg", lap.sun_elevation}});
  }
  if (result.rendered > 0) {
    const double rate = static_cast<double>(result.rendered) / result.seconds;
    figures["frames_per_second"] = rate;
    fmt::print("{} frames rendered in {:.1f} s, {:.1f} a second; {} were there\n", result.rendered,
               result.seconds, rate, result.kept);
  } else {
    fmt::print("all {} frames were there\n", result.kept);
  }
  WriteFigures(flags.common, figures);
}

}  // namespace

void AddSimulate(CLI::App& app) {
  auto flags = std::make_shared<SimulateFlags>();
  simulation::SimulateOptions& o = flags->options;
  CLI::App* command =
      AddCommand(app, "simulate", "Render drives through a simulated campus as a folder of laps",
                 flags->common, [flags] { RunSimulate(*flags); });
  command->add_option("--route", o.route, "ring, ufes:DIR (recorded poses) or FILE.tum")
      ->capture_default_str();
  command->add_option("--laps", o.laps, "laps to render, such as 1,3-5, or all")
      ->capture_default_str();
  command->add_option("--spacing", o.spacing, "metres between frames")->capture_default_str();
  command->add_option("--every", o.every, "render only every n-th of these frames")
      ->capture_default_str();
  command->add_option("--out", o.out, "folder of laps to make or go on with")
      ->type_name("DIR")
      ->required();
  command->add_flag("--stereo", o.stereo, "right images as well");
  command->add_option("--baseline", o.baseline, "metres between the cameras")
      ->capture_default_str();
  command->add_flag("--depth", o.depth, "true depth as well");
  command
      ->add_option("--depth-step", o.depth_step,
                   "depth of every n-th pixel of every n-th row, 1 or 2")
      ->capture_default_str();
  command->add_option("--change", o.change.strength, "how much days differ: 0 not at all")
      ->capture_default_str();
  command->add_option("--fixed", flags->fixed, "what does not change between days")
      ->check(CLI::IsMember({"light", "structures", "traffic", "season"}));
  command
      ->add_option("--weather", flags->weather,
                   "day (drawn for each), clear, fair, overcast, rain or mist")
      ->capture_default_str();
  command
      ->add_option("--faults", o.faults,
                   "camera faults: none, all, or a list such as black,frozen=0.05")
      ->capture_default_str();
  command
      ->add_option("--rolling-shutter", o.rolling_shutter, "seconds from the first row to the last")
      ->capture_default_str();
  command->add_option("--jpeg-quality", o.jpeg_quality, "10 to 100")->capture_default_str();
}

}  // namespace recollect::app
