#include "laps.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <numeric>

#include "recollect/core/error.h"

namespace recollect::app {

std::vector<Lap> ReadLapRange(const std::string& folder, Format format) {
  const std::size_t at = folder.rfind('@');
  if (at == std::string::npos || std::filesystem::exists(folder)) return ReadLaps(folder, format);
  char* end = nullptr;
  const std::string range = folder.substr(at + 1);
  const double from = std::strtod(range.c_str(), &end);
  const double to = *end == ':' ? std::strtod(end + 1, &end) : -1;
  Require(*end == '\0' && from >= 0 && from < to && to <= 1, folder,
          "the range after '@' is not FROM:TO with 0 <= FROM < TO <= 1");
  std::vector<Lap> laps = ReadLaps(folder.substr(0, at), format);
  for (Lap& lap : laps) {
    const auto count = static_cast<double>(lap.frames.size());
    std::vector<std::size_t> kept(static_cast<std::size_t>(std::llround(to * count)) -
                                  static_cast<std::size_t>(std::llround(from * count)));
    std::iota(kept.begin(), kept.end(), static_cast<std::size_t>(std::llround(from * count)));
    lap = Subset(lap, kept);
  }
  return laps;
}

void LapFlags::AddTo(CLI::App& command, bool required) {
  command
      .add_option("--lap", folders,
                  "a lap's folder, or a folder of laps; may be repeated;\n"
                  "DIR@FROM:TO takes a part of each lap, as in DIR@0:0.6")
      ->type_name("DIR")
      ->required(required);
  command.add_option("--format", format, "what the folders hold: guess, kitti, tum or ufes")
      ->capture_default_str();
}

std::vector<Lap> LapFlags::Read(bool worlds_apart) const {
  std::vector<Lap> laps;
  int world = 0;
  for (const std::string& folder : folders) {
    std::vector<Lap> some = ReadLapRange(folder, ParseFormat(format));
    for (Lap& lap : some) lap.world = world;
    world += worlds_apart;
    std::move(some.begin(), some.end(), std::back_inserter(laps));
  }
  return laps;
}

}  // namespace recollect::app
