#include "recollect/evaluation/html_report.h"

#include <nlohmann/json.hpp>

#include "recollect/core/error.h"
#include "recollect/core/files.h"

namespace recollect {
namespace {

// As the text of a <script>: nothing in it may end the element.
std::string AsScript(const nlohmann::json& data) {
  const std::string text = data.dump();
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) safe += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return safe;
}

void Fill(std::string& page, const std::string& id, const nlohmann::json& data,
          const std::string& where) {
  const std::string empty = fmt::format("id=\"{}\">null<", id);
  const std::size_t at = page.find(empty);
  Require(at != std::string::npos, where, fmt::format("has no place for '{}'", id),
          "build it again: cmake --build build --target web");
  page.replace(at + empty.size() - 5, 4, AsScript(data));
}

}  // namespace

void WriteHtmlReport(const nlohmann::json& run, const nlohmann::json& images,
                     const std::filesystem::path& page_template,
                     const std::filesystem::path& file) {
  Require(std::filesystem::exists(page_template), page_template.string(),
          "the page of reports was not built, npm was missing",
          "apt-get install nodejs npm, then make build; the figures are written, and a second run "
          "only adds the page");
  std::string page = ReadFile(page_template);
  Fill(page, "report-data", run, page_template.string());
  Fill(page, "report-images", images, page_template.string());
  AtomicWrite(file, page);
}

}  // namespace recollect
