#include "recollect/evaluation/gnuplot.h"

#include <cstdio>
#include <cstdlib>

#include "recollect/core/error.h"

namespace recollect {

void RunGnuplot(const std::string& script, const std::filesystem::path& where) {
  FILE* pipe = popen("gnuplot 2>/dev/null", "w");
  Require(pipe != nullptr, where.string(), "gnuplot cannot be started");
  const bool written = std::fwrite(script.data(), 1, script.size(), pipe) == script.size();
  const int status = pclose(pipe);
  Require(written && status == 0, where.string(), "gnuplot could not draw it",
          "install it with: apt-get install gnuplot-nox");
}

}  // namespace recollect
