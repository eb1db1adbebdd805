#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>

namespace recollect {

// The one error of the library. Its message is one line: where (a file with its line, a field or
// an option), what is wrong there, and what the user can do about it.
class Error : public std::runtime_error {
 public:
  Error(const std::string& where, const std::string& what, const std::string& remedy = "");
};

// Throws Error{where, what, remedy} unless `condition` holds.
inline void Require(bool condition, const std::string& where, const std::string& what,
                    const std::string& remedy = "") {
  if (!condition) throw Error(where, what, remedy);
}

// "file:line", the form in which errors name a place in a text file. Lines count from 1.
std::string AtLine(const std::string& file, std::size_t line);

}  // namespace recollect
