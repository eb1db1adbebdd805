#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <span>
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

  // Reads the file whole. `separator` is what stands between fields: ' ' means blanks and tabs,
  // any number of them; another character stands alone, and blanks about fields are dropped.
  explicit TextTable(const std::filesystem::path& path, char separator = ' ');
  TextTable(const TextTable&) = delete;
  TextTable& operator=(const TextTable&) = delete;

  const std::filesystem::path& path() const { return path_; }
  const std::vector<Row>& rows() const { return rows_; }

  // All rows but the first, which must consist of `header`, names with single blanks between them;
  // each must have as many fields.
  std::span<const Row> RowsAfterHeader(std::string_view header) const;

  // The finite number in a field of a row that has it.
  double Number(const Row& row, std::size_t field) const;
  // The first N fields, or those from `first` on.
  template <std::size_t N>
  std::array<double, N> Numbers(const Row& row, std::size_t first = 0) const {
    std::array<double, N> numbers;
    for (std::size_t i = 0; i < N; ++i) numbers[i] = Number(row, first + i);
    return numbers;
  }
  // A satellite fix's quality: a whole number from 0 to 9.
  int Quality(const Row& row, std::size_t field) const;

  // Throws Error unless `time`, of the row, is after `before`.
  void RequireAfter(const Row& row, double before, double time) const;
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
