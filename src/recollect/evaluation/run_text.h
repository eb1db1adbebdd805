#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace recollect {

// A run's tables (run_json.h) for the terminal. Each says whether the images are rendered or real.
std::string FormatRun(const nlohmann::json& run);

// The tables and curves of a run as CSV files of a folder: laps, accuracy, training, errors and
// paired. Errors frame by frame are in frames.csv (report.h).
void WriteRunCsv(const nlohmann::json& run, const std::filesystem::path& folder);

}  // namespace recollect
