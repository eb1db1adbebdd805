#include "recollect/map/map.h"

#include <fmt/format.h>

#include <memory>

#include "command.h"
#include "commands.h"
#include "laps.h"
#include "recollect/core/parallel.h"
#include "recollect/map/trials.h"
#include "recollect/matching/mapped.h"
#include "wnn_flags.h"

namespace recollect::app {
namespace {

struct Options {
  Common common;
  std::filesystem::path map;
  LapFlags laps;
  MapOptions create;
  bool geometry = true, calibrate = true;
};

// How sure the map's answers are, where there is enough of it to tell: poses, then places.
void Calibrate(const Options& options, ThreadPool& pool) {
  if (Map::Open(options.map).HasGeometry()) {
    matching::CalibrateMap(options.map, pool, TerminalProgress());
  }
  if (options.calibrate && Map::Open(options.map).size() >= 3) {
    CalibrateRecognition(options.map, pool, TerminalProgress());
  }
}

nlohmann::json Recognition(const MapDescription& d) {
  if (!d.recognition) return nullptr;
  nlohmann::json thresholds = nlohmann::json::object();
  for (const auto& one : d.recognition->thresholds) {
    thresholds[fmt::format("{:g}", one.precision)] = one.probability;
  }
  return {{"trials", d.recognition->trials}, {"thresholds", thresholds}};
}

nlohmann::json Describe(const Options& options) {
  const Map map = Map::Open(options.map);
  const MapDescription& d = map.description();
  nlohmann::json laps = nlohmann::json::array();
  for (const MapLap& lap : d.laps) {
    laps.push_back({{"name", lap.name}, {"key_frames", lap.key_frames}});
  }
  std::size_t bytes = 0, with_landmarks = 0;
  for (int key = 0; key < map.size(); ++key) {
    const auto geometry = map.Geometry(key);
    if (!geometry) continue;
    bytes += geometry->size();
    ++with_landmarks;
  }
  return {{"file", options.map.string()},
          {"bytes", map.FileBytes()},
          {"key_frames", map.size()},
          {"laps", laps},
          {"spacing_m", d.spacing_m},
          {"image", {{"width", d.camera.left.width}, {"height", d.camera.left.height}}},
          {"neurons", d.network.neurons()},
          {"geometry",
           {{"key_frames", with_landmarks},
            {"bytes_a_key_frame", with_landmarks > 0 ? bytes / with_landmarks : 0},
            {"inflation", d.geometry_inflation}}},
          {"recognition", Recognition(d)},
          {"seed", d.network.seed}};
}

void Show(const Options& options) {
  const nlohmann::json info = Describe(options);
  fmt::print("{}: {} key frames, {:.1f} MB\n", options.map.string(), info["key_frames"].get<int>(),
             info["bytes"].get<double>() / 1e6);
  fmt::print("  images {}x{}, {} neurons, a key frame every {} m\n",
             info["image"]["width"].get<int>(), info["image"]["height"].get<int>(),
             info["neurons"].get<int>(), info["spacing_m"].get<double>());
  const auto& geometry = info["geometry"];
  if (geometry["key_frames"].get<int>() > 0) {
    fmt::print("  landmarks of {} key frames, {:.1f} kB each; errors {:.2f} times their model\n",
               geometry["key_frames"].get<int>(), geometry["bytes_a_key_frame"].get<double>() / 1e3,
               geometry["inflation"].get<double>());
  }
  if (!info["recognition"].is_null()) {
    fmt::print("  how sure answers are: measured by {} trials\n",
               info["recognition"]["trials"].get<int>());
  }
  for (const auto& lap : info["laps"]) {
    fmt::print("  {:<24}{:>7} key frames\n", lap["name"].get<std::string>(),
               lap["key_frames"].get<int>());
  }
  WriteFigures(options.common, info);
}

}  // namespace

void AddMap(CLI::App& app) {
  CLI::App* map = app.add_subcommand("map", "Make maps and look at them");
  map->require_subcommand(1);

  const auto create = std::make_shared<Options>();
  CLI::App* command = AddCommand(*map, "create", "Make a map of laps", create->common, [create] {
    ThreadPool pool(create->common.threads);
    create->create.network.seed = create->common.seed;
    if (create->geometry) create->create.geometry = matching::LandmarkSource();
    CreateMap(create->map, create->laps.Read(), create->create, pool, TerminalProgress());
    Calibrate(*create, pool);
    Show(*create);
  });
  command->add_option("map", create->map, "file to write")->required()->type_name("MAP");
  create->laps.AddTo(*command);
  command->add_option("--spacing", create->create.spacing_m, "metres between key frames of a lap")
      ->capture_default_str();
  command
      ->add_flag("--geometry,!--no-geometry", create->geometry,
                 "keep landmarks of the key frames: features with depth, from depth images or\n"
                 "from the frames around (at most 60 kB a key frame)")
      ->default_str("true");
  const auto calibrate_flag = [](CLI::App& to, Options& options) {
    to.add_flag("--calibrate,!--no-calibrate", options.calibrate,
                "measure on the mapped laps how sure places are (see map calibrate)")
        ->default_str("true");
  };
  calibrate_flag(*command, *create);
  AddWnnFlags(*command, create->create.network);

  const auto add = std::make_shared<Options>();
  command = AddCommand(*map, "add", "Append laps to a map", add->common, [add] {
    ThreadPool pool(add->common.threads);
    AddToMap(add->map, add->laps.Read(), pool, TerminalProgress(), matching::LandmarkSource());
    Calibrate(*add, pool);
    Show(*add);
  });
  command->add_option("map", add->map, "file to append to")->required()->type_name("MAP");
  add->laps.AddTo(*command);
  calibrate_flag(*command, *add);

  const auto again = std::make_shared<Options>();
  command = AddCommand(*map, "calibrate",
                       "Measure on the mapped laps - each against the others, a single one with "
                       "changed light and viewpoint - how sure answers are, and keep it in the map",
                       again->common, [again] {
                         ThreadPool pool(again->common.threads);
                         Calibrate(*again, pool);
                         Show(*again);
                       });
  command->add_option("map", again->map, "the map")->required()->type_name("MAP");

  const auto info = std::make_shared<Options>();
  command = AddCommand(*map, "info", "Say what a map holds", info->common, [info] { Show(*info); });
  command->add_option("map", info->map, "file to look at")->required()->type_name("MAP");
}

}  // namespace recollect::app
