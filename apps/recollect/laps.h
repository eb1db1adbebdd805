#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "recollect/dataset/lap.h"

namespace recollect::app {

// The flags that name laps: --lap DIR (several, or a folder of laps) and --format.
struct LapFlags {
  std::vector<std::filesystem::path> folders;
  std::string format = "guess";

  void AddTo(CLI::App& command, bool required = true);
  // All laps of all folders, in the order given.
  std::vector<Lap> Read() const;
};

}  // namespace recollect::app
