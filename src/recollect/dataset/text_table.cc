#include "recollect/dataset/text_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "recollect/core/error.h"
#include "recollect/core/files.h"

namespace recollect {
namespace {

constexpr std::string_view kBlanks = " \t\r";

std::string_view Trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) + 1 - begin);
}

std::vector<std::string_view> Fields(std::string_view line, char separator) {
  std::vector<std::string_view> fields;
  if (separator == ' ') {
    for (std::size_t end = 0, begin = line.find_first_not_of(kBlanks);
         begin != std::string_view::npos; begin = line.find_first_not_of(kBlanks, end)) {
      end = std::min(line.find_first_of(kBlanks, begin), line.size());
      fields.push_back(line.substr(begin, end - begin));
    }
    return fields;
  }
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(separator, begin), line.size());
    fields.push_back(Trimmed(line.substr(begin, end - begin)));
    begin = end + 1;
  }
  return fields;
}

// The beginning of a field, fit for a message of one line.
std::string Shown(std::string_view field) {
  constexpr std::size_t kLength = 40;
  std::string shown(field.substr(0, kLength));
  std::replace_if(
      shown.begin(), shown.end(), [](unsigned char c) { return c < ' '; }, '?');
  return field.size() > kLength ? shown + "..." : shown;
}

}  // namespace

TextTable::TextTable(const std::filesystem::path& path, char separator)
    : path_(path), text_(ReadFile(path)) {
  const std::string_view text = text_;
  std::size_t line_number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = Trimmed(text.substr(begin, end - begin));
    ++line_number;
    if (!line.empty() && line.front() != '#') {
      rows_.push_back({line_number, Fields(line, separator)});
    }
    begin = end + 1;
  }
}

std::span<const TextTable::Row> TextTable::RowsAfterHeader(std::string_view header) const {
  const std::vector<std::string_view> names = Fields(header, ' ');
  Require(!rows_.empty(), path_.string(), "is empty");
  if (rows_.front().fields != names) {
    Fail(rows_.front(), fmt::format("not the header '{}'", header));
  }
  const auto rows = std::span(rows_).subspan(1);
  for (const Row& row : rows) RequireFields(row, names.size(), header);
  return rows;
}

double TextTable::Number(const Row& row, std::size_t field) const {
  const std::string_view text = row.fields.at(field);
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, code] = std::from_chars(text.data(), end, value);
  if (code != std::errc() || stop != end)
    Fail(row, fmt::format("'{}' is not a number", Shown(text)));
  if (!std::isfinite(value)) Fail(row, fmt::format("'{}' is not a finite number", Shown(text)));
  return value;
}

int TextTable::Quality(const Row& row, std::size_t field) const {
  const double quality = Number(row, field);
  if (quality < 0 || quality > 9 || quality != std::floor(quality)) {
    Fail(row, fmt::format("quality {} is none of 0..9", quality));
  }
  return static_cast<int>(quality);
}

void TextTable::RequireAfter(const Row& row, double before, double time) const {
  if (time <= before) Fail(row, fmt::format("time {} is not after {}", time, before));
}

void TextTable::RequireFields(const Row& row, std::size_t count, std::string_view what) const {
  if (row.fields.size() != count) {
    Fail(row, fmt::format("{} fields where {} belong ({})", row.fields.size(), count, what));
  }
}

void TextTable::Fail(const Row& row, const std::string& what, const std::string& remedy) const {
  throw Error(AtLine(path_.string(), row.line), what, remedy);
}

}  // namespace recollect
