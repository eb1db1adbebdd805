#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace recollect {

// The page that web/ is built into lies beside the program under this name.
inline constexpr const char* kReportTemplate = "report.html";

// Fills the page with a run and its images (run_json.h, thumbnails.h): one HTML file that needs
// nothing else. Throws Error, with what to install, where the template is missing, and where it is
// none.
void WriteHtmlReport(const nlohmann::json& run, const nlohmann::json& images,
                     const std::filesystem::path& page_template, const std::filesystem::path& file);

}  // namespace recollect
