#include "recollect/core/error.h"

namespace recollect {

Error::Error(const std::string& where, const std::string& what, const std::string& remedy)
    : std::runtime_error(remedy.empty() ? fmt::format("{}: {}", where, what)
                                        : fmt::format("{}: {}; {}", where, what, remedy)) {}

std::string AtLine(const std::string& file, std::size_t line) {
  return fmt::format("{}:{}", file, line);
}

}  // namespace recollect
