#include "recollect/benchmark/child_process.h"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstring>

#include "recollect/core/error.h"

namespace recollect {
namespace {

std::string ReadAll(int file) {
  std::string bytes;
  std::array<char, 4096> part;
  for (ssize_t got = 0; (got = read(file, part.data(), part.size())) > 0;) {
    bytes.append(part.data(), static_cast<std::size_t>(got));
  }
  return bytes;
}

}  // namespace

std::vector<double> RunInChild(const std::string& what,
                               const std::function<std::vector<double>()>& body) {
  std::array<int, 2> ends;
  Require(pipe(ends.data()) == 0, what, "no pipe to be had");
  const pid_t child = fork();
  Require(child >= 0, what, "no process to be had");
  if (child == 0) {
    int status = 0;
    std::string out;
    try {
      const std::vector<double> values = body();
      out.assign(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double));
    } catch (const std::exception& error) {
      out = error.what();
      status = 1;
    }
    const bool written = write(ends[1], out.data(), out.size()) == static_cast<ssize_t>(out.size());
    _exit(written ? status : 2);
  }
  close(ends[1]);
  const std::string out = ReadAll(ends[0]);
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  const bool well = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  Require(well, what, out.empty() || !WIFEXITED(status) ? "its process was lost" : out);
  std::vector<double> values(out.size() / sizeof(double));
  std::memcpy(values.data(), out.data(), values.size() * sizeof(double));
  return values;
}

}  // namespace recollect
