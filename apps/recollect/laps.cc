#include "laps.h"

#include <algorithm>
#include <iterator>

#include "recollect/dataset/reader.h"

namespace recollect::app {

void LapFlags::AddTo(CLI::App& command, bool required) {
  command.add_option("--lap", folders, "a lap's folder, or a folder of laps; may be repeated")
      ->type_name("DIR")
      ->required(required);
  command.add_option("--format", format, "what the folders hold: guess, kitti, tum or ufes")
      ->capture_default_str();
}

std::vector<Lap> LapFlags::Read() const {
  std::vector<Lap> laps;
  for (const std::filesystem::path& folder : folders) {
    std::vector<Lap> some = ReadLaps(folder, ParseFormat(format));
    std::move(some.begin(), some.end(), std::back_inserter(laps));
  }
  return laps;
}

}  // namespace recollect::app
