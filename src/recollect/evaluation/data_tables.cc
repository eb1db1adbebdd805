#include "recollect/evaluation/data_tables.h"

#include <algorithm>
#include <array>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <tuple>

#include "recollect/core/error.h"
#include "recollect/dataset/pairing.h"
#include "recollect/dataset/reader.h"
#include "recollect/dataset/registration.h"
#include "recollect/dataset/sampling.h"
#include "recollect/evaluation/statistics.h"

namespace recollect {
namespace {

// All counts of the paper rest on yaws compared as its authors did.
constexpr YawRule kRule = YawRule::kAsPublished;
constexpr double kMaxYaw = 10 * std::numbers::pi / 180;

constexpr const char* kRegistrationLap = "20140418";
constexpr std::array kRecordings = {"20160825", "20160825-01", "20160825-02", "20160830",
                                    "20161021", "20170119",    "20171122",    "20171205",
                                    "20180112", "20180112-02"};
// Positions in kRecordings.
constexpr std::size_t kValidLap = 3, kTestLap = 6;
using LapSet = std::vector<std::size_t>;
const LapSet kPlaceLaps = {0, 1, 2, 7, 8, 9};     // that the place recogniser learns
const LapSet kPairLaps = {0, 1, 2, 4, 7, 8, 9};   // that the network learns
const LapSet kOtherKeyLaps = {1, 2, 4, 7, 8, 9};  // key frames of validation and test

const Lap& Find(const std::vector<Lap>& laps, const std::string& name,
                const std::filesystem::path& folder) {
  const auto found =
      std::find_if(laps.begin(), laps.end(), [&](const Lap& lap) { return lap.name == name; });
  Require(found != laps.end(), (folder / fmt::format("camerapos-{}.txt", name)).string(),
          "no such file", "the tables need all ten laps and the registration lap");
  return *found;
}

// The distances of all pairs of live laps at 1 m with key laps at 5 m.
std::vector<double> PairDistances(const std::vector<Lap>& live, const std::vector<Lap>& key,
                                  const LapSet& live_laps, const LapSet& key_laps) {
  PairingOptions options;
  options.yaw_rule = kRule;
  std::vector<double> distances;
  for (const std::size_t l : live_laps) {
    for (const std::size_t k : key_laps) {
      for (const FramePair& pair : PairAlongRoute(live[l], key[k], l == k, options)) {
        distances.push_back((live[l].frames[pair.live].world_from_body.Inverse() *
                             key[k].frames[pair.key].world_from_body)
                                .translation()
                                .norm());
      }
    }
  }
  return distances;
}

// For each frame the distance to the nearest key frame of the given laps that heads its way.
std::vector<double> NearestDistances(const Lap& live, const std::vector<Lap>& key,
                                     const LapSet& key_laps) {
  const Track track = MakeTrack(live, kRule);
  std::vector<double> nearest(track.size(), std::numeric_limits<double>::infinity());
  for (const std::size_t k : key_laps) {
    const Track key_track = MakeTrack(key[k], kRule);
    for (std::size_t i = 0; i < track.size(); ++i) {
      for (std::size_t j = 0; j < key_track.size(); ++j) {
        const double distance = (track.positions[i] - key_track.positions[j]).norm();
        if (distance < nearest[i] &&
            HeadingDifference(track, i, key_track, j) <= std::numbers::pi / 2) {
          nearest[i] = distance;
        }
      }
    }
  }
  return nearest;
}

// The errors of the satellite fixes nearest in time to the frames, where those are any good.
std::vector<double> GpsErrors(const Lap& lap) {
  std::vector<double> errors;
  for (const Frame& frame : lap.frames) {
    const GpsFix* fix = NearestFix(lap, frame.time);
    if (fix != nullptr && fix->quality > 0) {
      errors.push_back((fix->p_world - frame.world_from_body.translation()).norm());
    }
  }
  return errors;
}

std::size_t Count(const Registration& registration) {
  std::size_t count = 0;
  for (const PlacedFrames& placed : registration.train) count += placed.frames.size();
  return count;
}

}  // namespace

DataTables ComputeDataTables(const std::filesystem::path& folder) {
  const std::vector<Lap> all = ReadLaps(folder, Format::kUfes);
  DataTables tables;
  std::vector<const Lap*> laps;
  std::vector<Lap> live, key;
  for (const char* name : kRecordings) {
    const Lap& lap = *laps.emplace_back(&Find(all, name, folder));
    live.push_back(Subset(lap, SampleFrames(lap, 1, kMaxYaw, kRule)));
    key.push_back(Subset(lap, SampleFrames(lap, 5, kMaxYaw, kRule)));
    tables.laps.push_back({fmt::format("{:02}", laps.size()), lap.name, lap.frames.size(),
                           live.back().frames.size(), key.back().frames.size()});
  }

  RegistrationOptions options;
  options.yaw_rule = kRule;
  std::vector<const Lap*> train;
  for (const std::size_t lap : kPlaceLaps) train.push_back(laps[lap]);
  const Registration registration =
      RegisterPlaces(Find(all, kRegistrationLap, folder), *laps[kTestLap], train, options);
  tables.registration = {registration.places.size(), Count(registration),
                         registration.test.frames.size()};

  const auto with = [](LapSet laps_of_keys, std::size_t own) {
    laps_of_keys.push_back(own);
    return laps_of_keys;
  };
  const auto test_pairs = PairDistances(live, key, {kTestLap}, with(kOtherKeyLaps, kTestLap));
  tables.pairs = {PairDistances(live, key, kPairLaps, kPairLaps).size(),
                  PairDistances(live, key, {kValidLap}, with(kOtherKeyLaps, kValidLap)).size(),
                  test_pairs.size()};

  const Lap& test = live[kTestLap];
  Require(!test.gps.empty(), (folder / fmt::format("cameragps-{}.txt", test.name)).string(),
          "no satellite fixes", "the tables need those of the test lap");
  const Summary gps = Summarise(GpsErrors(test));
  tables.gps = {static_cast<double>(gps.count) / static_cast<double>(test.frames.size()), gps.mean,
                gps.median, gps.p75};
  tables.baselines = {Summarise(NearestDistances(test, key, kPlaceLaps)).mean,
                      Summarise(NearestDistances(test, key, {0})).mean, Summarise(test_pairs).mean};
  return tables;
}

std::string Describe(const DataTables& tables) {
  std::string text =
      fmt::format("{:<5}{:<13}{:>7}{:>8}{:>8}\n", "lap", "recording", "frames", "at 1 m", "at 5 m");
  for (const DataTables::LapRow& row : tables.laps) {
    text += fmt::format("{:<5}{:<13}{:>7}{:>8}{:>8}\n", row.lap, row.name, row.rows, row.at_1m,
                        row.at_5m);
  }
  const auto& [classes, train, test] = tables.registration;
  text += fmt::format("\nplaces         {} classes, {} training frames, {} test frames\n", classes,
                      train, test);
  const auto& pairs = tables.pairs;
  text += fmt::format("pairs          {} training, {} validation, {} test\n", pairs.train,
                      pairs.valid, pairs.test);
  text += "\nposition error on the test lap, no image used\n";
  const auto& gps = tables.gps;
  text += fmt::format(
      "RTK-GPS        mean {:.3f} m, median {:.3f} m, p75 {:.3f} m on {:.2f} % of "
      "the frames\n",
      gps.mean, gps.median, gps.p75, 100 * gps.available);
  const auto& baselines = tables.baselines;
  text +=
      fmt::format("nearest        mean {:.3f} m to the nearest key frame of all training laps\n",
                  baselines.nearest_all_mean);
  text += fmt::format("nearest, one   mean {:.3f} m to the nearest key frame of lap 01\n",
                      baselines.nearest_one_lap_mean);
  text +=
      fmt::format("no motion      mean {:.3f} m over the test pairs\n", baselines.no_motion_mean);
  return text;
}

nlohmann::json ToJson(const DataTables& tables) {
  nlohmann::json laps = nlohmann::json::array();
  for (const DataTables::LapRow& row : tables.laps) {
    laps.push_back({{"lap", row.lap},
                    {"name", row.name},
                    {"rows", row.rows},
                    {"at_1m", row.at_1m},
                    {"at_5m", row.at_5m}});
  }
  const auto& [registration, pairs, gps, baselines] =
      std::tie(tables.registration, tables.pairs, tables.gps, tables.baselines);
  return {{"laps", laps},
          {"registration",
           {{"classes", registration.classes},
            {"train", registration.train},
            {"test", registration.test}}},
          {"pairs", {{"train", pairs.train}, {"valid", pairs.valid}, {"test", pairs.test}}},
          {"gps",
           {{"available", gps.available},
            {"mean_m", gps.mean},
            {"median_m", gps.median},
            {"p75_m", gps.p75}}},
          {"baselines",
           {{"nearest_all_mean_m", baselines.nearest_all_mean},
            {"nearest_one_lap_mean_m", baselines.nearest_one_lap_mean},
            {"no_motion_mean_m", baselines.no_motion_mean}}}};
}

}  // namespace recollect
