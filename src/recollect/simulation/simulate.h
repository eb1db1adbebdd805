#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "recollect/core/progress.h"
#include "recollect/simulation/day.h"

namespace recollect::simulation {

// What to render and where to put it.
struct SimulateOptions {
  std::string route = "ring";  // "ring", "ufes:FOLDER" or a TUM trajectory "FILE.tum"
  std::string laps = "1-3";    // such as "1,2,5-7" or, for recorded routes, "all"
  double spacing = 1;          // metres between frames (a turn of 10 degrees makes one, too)
  int every = 1;               // render only every n-th of these frames
  std::filesystem::path out;   // the folder of laps to make or to go on with
  bool stereo = false;         // right images as well
  bool depth = false;          // true depth as well
  int depth_step = 2;          // of every n-th pixel of every n-th row; 1 or 2
  double baseline = 0.24004;   // metres between the cameras
  Change change;
  Weather weather = Weather::kByDay;
  std::string faults = "none";  // see ParseFaults
  double rolling_shutter = 0;   // seconds from the first row to the last; 0: global shutter
  int jpeg_quality = 92;
  std::uint64_t seed = 1;  // of the campus and of all that happens there
  int threads = 0;         // 0: one for each core; changes no bit of the result
};

struct SimulateResult {
  struct Lap {
    int number = 0;
    std::int64_t frames = 0;
    std::string weather;
    double sun_elevation = 0;  // degrees at the lap's start
  };
  std::vector<Lap> laps;
  std::int64_t rendered = 0;  // frames made now
  std::int64_t kept = 0;      // frames found from a run before
  double seconds = 0;         // for rendering and writing, without the preparation
};

// Renders laps of a route as a folder of laps in KITTI's layout, with the additions of
// kitti_reader.h (depth, gps.csv) and `gps.nmea`, `odometry.csv` and `lap.txt`; `README.md` beside
// the laps says how they were made. A lap grows in a hidden folder and gets its name when it is
// whole, so no reader ever sees half of one; begun again with the same options, it goes on where
// it stopped. Throws Error for options and routes that make no sense before anything is written,
// and for folders and disks that take no more.
SimulateResult Simulate(const SimulateOptions& options, const ProgressSink& progress = {});

// The lap numbers of a list such as "1,3-5", increasing, each once; "all" is 1 to `count`. Throws
// Error where it is no such list.
std::vector<int> ParseLaps(std::string_view list, int count);

}  // namespace recollect::simulation
