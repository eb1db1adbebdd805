#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "recollect/evaluation/bootstrap.h"

namespace recollect {

// Runs side by side: files that `recollect experiment paper` wrote as run.json.

// Throws Error naming the file where it is no run.
nlohmann::json ReadRun(const std::filesystem::path& file);

// {runs: [{name, images, data_hash, seed, rows: [{name, label, mean, median, p95, availability}],
//          places}],
// paired: [{run, row, frames, difference}]}: of each later run the rows less those of the first,
// frame by frame, where both are of the same data and live images. `names` as the table says them.
nlohmann::json CompareRuns(const std::vector<nlohmann::json>& runs,
                           const std::vector<std::string>& names,
                           const BootstrapOptions& bootstrap = {});

// The table of what CompareRuns gives.
std::string FormatComparison(const nlohmann::json& comparison);

}  // namespace recollect
