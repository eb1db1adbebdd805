#include "recollect/benchmark/shard_bench.h"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/core/random.h"
#include "recollect/core/stopwatch.h"
#include "recollect/wnn/shard.h"

namespace recollect {
namespace {

// Rank r's share of the blocks: the memory itself is not copied, forked processes share it.
wnn::Memory SliceOf(const wnn::Memory& whole, int rank, int ranks) {
  wnn::Memory slice(whole.neurons());
  const std::size_t blocks = whole.blocks().size();
  const auto r = static_cast<std::size_t>(rank), all = static_cast<std::size_t>(ranks);
  for (std::size_t b = blocks * r / all; b < blocks * (r + 1) / all; ++b) {
    slice.AddBlock(whole.blocks()[b]);
  }
  return slice;
}

ShardFigures RunRank(const Corpus& corpus, int threads, std::uint64_t tie_seed,
                     const wnn::ShardOptions& options) {
  const wnn::Memory slice = SliceOf(corpus.memory, options.rank, options.ranks);
  ThreadPool pool(threads);
  wnn::Shard shard(slice, pool, options);
  ShardFigures figures{options.ranks, 0, 0};
  std::vector<double> times;
  for (const Pattern& pattern : corpus.live) {
    const Stopwatch watch;
    const wnn::Recollection r = shard.Recollect(pattern, {.tie_seed = tie_seed});
    times.push_back(watch.Milliseconds());
    figures.digest = Digest(r.answers, figures.digest);
  }
  std::sort(times.begin(), times.end());
  figures.search_ms = times[times.size() / 2];
  return figures;
}

}  // namespace

std::uint64_t Digest(std::span<const wnn::Answer> answers, std::uint64_t before) {
  for (const wnn::Answer answer : answers) before = Scramble(before ^ answer);
  return before;
}

ShardFigures RunShardBench(const Corpus& corpus, int ranks, int threads, std::uint64_t tie_seed) {
  Require(ranks >= 1 && !corpus.live.empty(), "bench", "needs a rank and a live image");
  const auto rendezvous = std::filesystem::temp_directory_path() /
                          fmt::format("recollect-bench-{}", static_cast<int>(getpid()));
  std::array<int, 2> pipe_ends;
  Require(pipe(pipe_ends.data()) == 0, "bench", "no pipe to be had");
  std::vector<pid_t> children;
  for (int rank = 0; rank < ranks; ++rank) {
    const pid_t child = fork();
    Require(child >= 0, "bench", "no process to be had");
    if (child > 0) {
      children.push_back(child);
      continue;
    }
    try {
      const ShardFigures figures =
          RunRank(corpus, threads, tie_seed,
                  {.rendezvous = rendezvous, .rank = rank, .ranks = ranks, .timeout_s = 60});
      if (rank == 0 && write(pipe_ends[1], &figures, sizeof(figures)) < 0) _exit(1);
      _exit(0);
    } catch (const std::exception&) {
      _exit(1);
    }
  }
  close(pipe_ends[1]);
  ShardFigures figures;
  const auto got = read(pipe_ends[0], &figures, sizeof(figures));
  close(pipe_ends[0]);
  bool all_well = got == static_cast<ssize_t>(sizeof(figures));
  for (const pid_t child : children) {
    int status = 0;
    waitpid(child, &status, 0);
    all_well = all_well && WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }
  std::filesystem::remove(rendezvous);
  Require(all_well, "bench", "a rank of the sharded search failed");
  return figures;
}

}  // namespace recollect
