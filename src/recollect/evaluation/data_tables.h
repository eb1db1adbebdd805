#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace recollect {

// The tables of the paper that tell of its data, and the baselines that need no image, computed
// from the poses of UFES-LAPS (Forechi et al. 2018, section IV). Distances in metres.
struct DataTables {
  struct LapRow {
    std::string lap;   // as the paper counts them: "01" to "10"
    std::string name;  // the recording
    std::size_t rows = 0, at_1m = 0, at_5m = 0;
  };
  std::vector<LapRow> laps;

  // Places of the registration lap at 5 m; frames of the training and test laps with a place.
  struct {
    std::size_t classes = 0, train = 0, test = 0;
  } registration;

  // Live frames at 1 m with a key frame at 5 m. Validation is lap 04, test lap 07; their key frames
  // and both sides of training are the other laps, and of each the lap itself.
  struct {
    std::size_t train = 0, valid = 0, test = 0;
  } pairs;

  // RTK-GPS on the test lap at 1 m: the share of frames whose nearest fix in time is one, and the
  // distance of those from the true position.
  struct {
    double available = 0, mean = 0, median = 0, p75 = 0;
  } gps;

  // Taking a key frame's position for one's own: of the nearest 5 m key frame of all training
  // laps, or of lap 01, and of the key frame of each test pair.
  struct {
    double nearest_all_mean = 0, nearest_one_lap_mean = 0, no_motion_mean = 0;
  } baselines;
};

// Reads the folder of UFES-LAPS (see ufes_reader.h) and computes all of it: some seconds. Throws
// Error when a recording is missing or the folder cannot be read.
DataTables ComputeDataTables(const std::filesystem::path& folder);

// As a text for people.
std::string Describe(const DataTables& tables);

// Keys: laps (list of name, rows, at_1m, at_5m), registration (classes, train, test), pairs (train,
// valid, test), gps (available, mean_m, median_m, p75_m), baselines (nearest_all_mean_m,
// nearest_one_lap_mean_m, no_motion_mean_m).
nlohmann::json ToJson(const DataTables& tables);

}  // namespace recollect
