#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <numbers>

#include "command.h"
#include "commands.h"
#include "recollect/core/error.h"
#include "recollect/dataset/pairing.h"
#include "recollect/dataset/reader.h"
#include "recollect/dataset/registration.h"
#include "recollect/dataset/sampling.h"

namespace recollect::app {
namespace {

constexpr double kRadians = std::numbers::pi / 180;

struct DatasetFlags {
  Common common;
  std::filesystem::path folder;
  std::string format = "guess";
  double max_yaw_deg = 10;
  bool yaw_as_published = false;

  std::vector<Lap> Read() const { return ReadLaps(folder, ParseFormat(format)); }
  YawRule yaw_rule() const { return yaw_as_published ? YawRule::kAsPublished : YawRule::kShortest; }
  std::vector<std::size_t> Sample(const Lap& lap, double spacing) const {
    return SampleFrames(lap, spacing, max_yaw_deg * kRadians, yaw_rule());
  }
};

struct SampleFlags : DatasetFlags {
  double spacing = 1;
};

struct RegisterFlags : DatasetFlags {
  std::string reference, test;
  std::vector<std::string> train;
  RegistrationOptions registration;
};

struct PairsFlags : DatasetFlags {
  std::vector<std::string> live, key;
  double live_spacing = 1, key_spacing = 5;
  double within = 0;  // metres; 0 pairs along the route
  double max_angle_deg = 90;
  PairingOptions pairing;
};

const Lap& Find(const std::vector<Lap>& laps, const std::string& name) {
  const auto found =
      std::find_if(laps.begin(), laps.end(), [&](const Lap& lap) { return lap.name == name; });
  if (found != laps.end()) return *found;
  std::string names;
  for (const Lap& lap : laps) names += (names.empty() ? "" : ", ") + lap.name;
  throw Error(name, "there is no lap of that name", "there are " + names);
}

// The laps of the given names, all where none is given.
std::vector<const Lap*> Select(const std::vector<Lap>& laps,
                               const std::vector<std::string>& names) {
  std::vector<const Lap*> selected;
  for (const std::string& name : names) selected.push_back(&Find(laps, name));
  if (names.empty()) {
    for (const Lap& lap : laps) selected.push_back(&lap);
  }
  return selected;
}

void Info(const DatasetFlags& flags) {
  nlohmann::json figures = {{"laps", nlohmann::json::array()}};
  fmt::print("{:<20}{:>8}{:>9}{:>9}{:>8}{:>8}{:>8}{:>8}  {}\n", "lap", "frames", "m", "s", "left",
             "right", "depth", "gps", "image");
  for (const Lap& lap : flags.Read()) {
    const auto count = [&](std::filesystem::path Frame::*image) {
      return std::count_if(lap.frames.begin(), lap.frames.end(),
                           [&](const Frame& frame) { return !(frame.*image).empty(); });
    };
    const double length = PathLength(lap);
    const double duration = lap.frames.back().time - lap.frames.front().time;
    const auto left = count(&Frame::left), right = count(&Frame::right),
               depth = count(&Frame::depth);
    const PinholeCamera& camera = lap.camera.left;
    fmt::print("{:<20}{:>8}{:>9.1f}{:>9.1f}{:>8}{:>8}{:>8}{:>8}  {}x{}\n", lap.name,
               lap.frames.size(), length, duration, left, right, depth, lap.gps.size(),
               camera.width, camera.height);
    figures["laps"].push_back({{"name", lap.name},
                               {"frames", lap.frames.size()},
                               {"length_m", length},
                               {"duration_s", duration},
                               {"left_images", left},
                               {"right_images", right},
                               {"depth_images", depth},
                               {"gps_fixes", lap.gps.size()},
                               {"camera",
                                {{"width", camera.width},
                                 {"height", camera.height},
                                 {"fx", camera.fx},
                                 {"fy", camera.fy},
                                 {"cx", camera.cx},
                                 {"cy", camera.cy},
                                 {"baseline_m", lap.camera.baseline}}}});
  }
  WriteFigures(flags.common, figures);
}

void Sample(const SampleFlags& flags) {
  nlohmann::json figures = {{"spacing_m", flags.spacing}, {"laps", nlohmann::json::array()}};
  fmt::print("{:<20}{:>8}{:>8}\n", "lap", "frames", "kept");
  for (const Lap& lap : flags.Read()) {
    const std::vector<std::size_t> kept = flags.Sample(lap, flags.spacing);
    fmt::print("{:<20}{:>8}{:>8}\n", lap.name, lap.frames.size(), kept.size());
    figures["laps"].push_back({{"name", lap.name},
                               {"rows", lap.frames.size()},
                               {"count", kept.size()},
                               {"frames", kept}});
  }
  WriteFigures(flags.common, figures);
}

void Register(RegisterFlags flags) {
  flags.registration.yaw_rule = flags.yaw_rule();
  const std::vector<Lap> laps = flags.Read();
  std::vector<const Lap*> train = Select(laps, flags.train);
  if (flags.train.empty()) {
    std::erase_if(train, [&](const Lap* lap) {
      return lap->name == flags.reference || lap->name == flags.test;
    });
  }
  const Registration registration = RegisterPlaces(
      Find(laps, flags.reference), Find(laps, flags.test), train, flags.registration);
  const auto placed = [](const std::string& name, const PlacedFrames& lap) {
    return nlohmann::json{{"name", name}, {"frames", lap.frames}, {"places", lap.places}};
  };
  nlohmann::json train_laps = nlohmann::json::array();
  std::size_t train_frames = 0;
  for (std::size_t i = 0; i < train.size(); ++i) {
    train_frames += registration.train[i].frames.size();
    train_laps.push_back(placed(train[i]->name, registration.train[i]));
  }
  fmt::print("{} places, {} training frames, {} test frames\n", registration.places.size(),
             train_frames, registration.test.frames.size());
  WriteFigures(flags.common, {{"classes", registration.places.size()},
                              {"train", train_frames},
                              {"test", registration.test.frames.size()},
                              {"place_frames", registration.places},
                              {"test_lap", placed(flags.test, registration.test)},
                              {"train_laps", train_laps}});
}

void Pairs(PairsFlags flags) {
  flags.pairing.yaw_rule = flags.yaw_rule();
  const std::vector<Lap> laps = flags.Read();
  nlohmann::json figures = {{"count", 0}, {"laps", nlohmann::json::array()}};
  std::size_t count = 0;
  for (const Lap* live : Select(laps, flags.live)) {
    const auto live_frames = flags.Sample(*live, flags.live_spacing);
    for (const Lap* key : Select(laps, flags.key)) {
      const auto key_frames = flags.Sample(*key, flags.key_spacing);
      const Lap live_lap = Subset(*live, live_frames), key_lap = Subset(*key, key_frames);
      const std::vector<FramePair> pairs =
          flags.within > 0
              ? PairsWithin(live_lap, key_lap, flags.within, flags.max_angle_deg * kRadians)
              : PairAlongRoute(live_lap, key_lap, live == key, flags.pairing);
      nlohmann::json indices = nlohmann::json::array();
      for (const FramePair& pair : pairs) {
        indices.push_back({live_frames[pair.live], key_frames[pair.key]});
      }
      fmt::print("{:<20}{:<20}{:>8}\n", live->name, key->name, pairs.size());
      figures["laps"].push_back({{"live", live->name}, {"key", key->name}, {"pairs", indices}});
      count += pairs.size();
    }
  }
  fmt::print("{:<40}{:>8}\n", "pairs", count);
  figures["count"] = count;
  WriteFigures(flags.common, figures);
}

void AddFolder(CLI::App& command, DatasetFlags& flags) {
  command.add_option("folder", flags.folder, "a lap, or a folder of laps")
      ->type_name("DIR")
      ->required();
  command.add_option("--format", flags.format, "what it holds: guess, kitti, tum or ufes")
      ->capture_default_str();
}

void AddYaw(CLI::App& command, DatasetFlags& flags) {
  command.add_flag("--yaw-as-published", flags.yaw_as_published,
                   "compare yaws without regard to their jump at a half turn, as the paper's "
                   "authors did");
}

void AddSampling(CLI::App& command, DatasetFlags& flags) {
  command
      .add_option("--max-yaw", flags.max_yaw_deg, "a turn by so many degrees keeps a frame, too")
      ->capture_default_str();
  AddYaw(command, flags);
}

}  // namespace

void AddDataset(CLI::App& app) {
  CLI::App* dataset = app.add_subcommand("dataset", "Look at laps, thin, register and pair them");
  dataset->require_subcommand(1);

  const auto info = std::make_shared<DatasetFlags>();
  CLI::App* command = AddCommand(*dataset, "info", "Say what a folder holds, and check it",
                                 info->common, [info] { Info(*info); });
  AddFolder(*command, *info);

  const auto sample = std::make_shared<SampleFlags>();
  command = AddCommand(*dataset, "sample", "Thin laps to one frame every few metres",
                       sample->common, [sample] { Sample(*sample); });
  AddFolder(*command, *sample);
  command->add_option("--spacing", sample->spacing, "metres")->capture_default_str();
  AddSampling(*command, *sample);

  const auto registers = std::make_shared<RegisterFlags>();
  command = AddCommand(*dataset, "register", "Label frames with the places of a reference lap",
                       registers->common, [registers] { Register(*registers); });
  AddFolder(*command, *registers);
  command->add_option("--reference", registers->reference, "the lap that gives the places")
      ->type_name("NAME")
      ->required();
  command->add_option("--test", registers->test, "the lap that is labelled whole")
      ->type_name("NAME")
      ->required();
  command->add_option("--train", registers->train, "laps of one frame a place; default: the others")
      ->type_name("NAME");
  RegistrationOptions& registration = registers->registration;
  command->add_option("--place-spacing", registration.place_spacing, "metres between places")
      ->capture_default_str();
  command->add_option("--frame-spacing", registration.frame_spacing, "metres between frames")
      ->capture_default_str();
  command->add_option("--max-distance", registration.max_distance, "metres from frame to place")
      ->capture_default_str();
  AddYaw(*command, *registers);

  const auto pairs = std::make_shared<PairsFlags>();
  command = AddCommand(*dataset, "pairs", "Pair live frames with key frames", pairs->common,
                       [pairs] { Pairs(*pairs); });
  AddFolder(*command, *pairs);
  command->add_option("--live", pairs->live, "laps of live frames; default: all")
      ->type_name("NAME");
  command->add_option("--key", pairs->key, "laps of key frames; default: all")->type_name("NAME");
  command->add_option("--live-spacing", pairs->live_spacing, "metres")->capture_default_str();
  command->add_option("--key-spacing", pairs->key_spacing, "metres")->capture_default_str();
  command->add_option("--within", pairs->within,
                      "all pairs of cameras so many metres apart; without it, the paper's one key "
                      "frame a live frame and lap");
  command->add_option("--max-angle", pairs->max_angle_deg, "with --within: degrees of heading")
      ->capture_default_str();
  command->add_option("--max-distance", pairs->pairing.max_distance, "metres, without --within")
      ->capture_default_str();
  command
      ->add_option("--min-distance", pairs->pairing.min_distance,
                   "metres between different laps, without --within")
      ->capture_default_str();
  AddSampling(*command, *pairs);
}

}  // namespace recollect::app
