#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace recollect {

// The figures of a run (run_json.h) as SVG files of a folder: accuracy, training (where there is a
// curve), errors (box plots), along and plan. Drawn by gnuplot; throws Error, with what to install,
// where that is missing.
void DrawRun(const nlohmann::json& run, const std::filesystem::path& folder);

}  // namespace recollect
