#include "local_ranks.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <exception>
#include <vector>

#include "recollect/core/error.h"

namespace recollect::app {
namespace {

// A port of this machine that nobody listens at now.
int FreePort() {
  const int listener = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof(address);
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  const bool found = listener >= 0 && bind(listener, generic, length) == 0 &&
                     getsockname(listener, generic, &length) == 0;
  if (listener >= 0) close(listener);
  Require(found, "--ranks", "no free port on this machine");
  return ntohs(address.sin_port);
}

bool AllWell(const std::vector<pid_t>& children) {
  bool well = true;
  for (const pid_t child : children) {
    int status = 0;
    waitpid(child, &status, 0);
    well = well && WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }
  return well;
}

}  // namespace

void RunLocalRanks(int ranks, const std::function<void(const cnn::RankOptions&)>& body) {
  cnn::RankOptions options;
  options.ranks = ranks;
  options.port = FreePort();
  std::vector<pid_t> children;
  for (int rank = 1; rank < ranks; ++rank) {
    const pid_t child = fork();
    Require(child >= 0, "--ranks", "no process to be had");
    if (child > 0) {
      children.push_back(child);
      continue;
    }
    try {
      options.rank = rank;
      body(options);
      _exit(0);
    } catch (const std::exception& error) {
      fmt::print(stderr, "recollect: {}\n", error.what());
      _exit(1);
    }
  }
  try {
    body(options);
  } catch (...) {
    AllWell(children);  // they notice that this rank has gone
    throw;
  }
  Require(AllWell(children), "--ranks", "one of the processes failed");
}

}  // namespace recollect::app
