#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace recollect {

// A text file of rows of fields. Blank lines and lines that begin with '#' are left out; lines may
// end in LF or CRLF. Every error names the file and, where there is one, the line.
class TextTable {
 public:
  struct Row {
    std::size_t line = 0;  // counted from 1
    std::vector<std::string_view> fields;
  };

  // Reads the file whole. `separators` are the characters between fields; blanks at either end
  // of a field never belong to it. Throws Error when the file cannot be read.
  explicit TextTable(const std::filesystem::path& path, char separator = ' ');
  TextTable(const TextTable&) = delete;
  TextTable& operator=(const TextTable&) = delete;

  const std::filesystem::path& path() const { return path_; }
  const std::vector<Row>& rows() const { return rows_; }

  // The finite number in a field of a row that has it. Throws Error where it is none.
  double Number(const Row& row, std::size_t field) const;
  // Throws Error unless the row has `count` fields; `what` says what they should be.
  void RequireFields(const Row& row, std::size_t count, std::string_view what) const;
  [[noreturn]] void Fail(const Row& row, const std::string& what,
                         const std::string& remedy = "") const;

 private:
  std::filesystem::path path_;
  std::string text_;  // what the fields point into
  std::vector<Row> rows_;
};

}  // namespace recollect
