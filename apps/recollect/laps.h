#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "recollect/dataset/lap.h"
#include "recollect/dataset/reader.h"

namespace recollect::app {

// The laps of a folder, or of "FOLDER@FROM:TO" with only those frames of each whose place in the
// lap, from 0 for its first to 1 for its end, is within [FROM, TO).
std::vector<Lap> ReadLapRange(const std::string& folder, Format format);

// The flags that name laps: --lap DIR (several, or a folder of laps) and --format.
struct LapFlags {
  std::vector<std::string> folders;  // each may end in @FROM:TO
  std::string format = "guess";

  void AddTo(CLI::App& command, bool required = true);
  // All laps of all folders, in the order given. `worlds_apart`: each folder is a world of its own.
  std::vector<Lap> Read(bool worlds_apart = false) const;
};

}  // namespace recollect::app
