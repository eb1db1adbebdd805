// Searches over processes: the ranks are children of the test, so that one can be killed.
#include "recollect/wnn/shard.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <functional>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/core/stopwatch.h"
#include "recollect/testing/scratch_folder.h"
#include "recollect/wnn/test_patterns.h"

namespace recollect::wnn {
namespace {

constexpr int kNeurons = 300;

// Runs rank(r) in a process of its own for each r; returns what they exited with, -1 if killed.
std::vector<int> RunRanks(int ranks, const std::function<int(int)>& rank) {
  std::vector<pid_t> children;
  for (int r = 0; r < ranks; ++r) {
    const pid_t child = fork();
    if (child == 0) {
      int code = 99;
      try {
        code = rank(r);
      } catch (const std::exception& error) {
        fprintf(stderr, "rank %d: %s\n", r, error.what());
      }
      _exit(code);
    }
    children.push_back(child);
  }
  std::vector<int> codes;
  for (const pid_t child : children) {
    int status = 0;
    waitpid(child, &status, 0);
    codes.push_back(WIFEXITED(status) ? WEXITSTATUS(status) : -1);
  }
  return codes;
}

// Entries [begin, end) of a memory full of ties.
Memory Slice(int begin, int end) {
  Memory memory(kNeurons);
  for (int i = begin; i < end; ++i) {
    auto pattern = RandomPattern(kNeurons, static_cast<std::uint64_t>(i));
    for (auto& word : pattern) word &= 0x1111000000001111;
    memory.Append(pattern);
  }
  return memory;
}

TEST(Shard, AnswersBitForBitAsOneProcessWould) {
  const testing::ScratchFolder folder;
  for (const int ranks : {2, 3}) {
    const auto file = folder / std::to_string(ranks);
    const auto codes = RunRanks(ranks, [&](int rank) {
      const int cuts[] = {0, 40, ranks == 2 ? 130 : 41, 130};
      const Memory slice = Slice(cuts[rank], cuts[rank + 1]), whole = Slice(0, 130);
      ThreadPool pool(2);
      Shard shard(slice, pool, {.rendezvous = file, .rank = rank, .ranks = ranks});
      if (shard.entries() != 130 || shard.first_entry() != cuts[rank]) return 1;
      for (std::uint64_t i = 0; i < 20; ++i) {
        const auto query = RandomPattern(kNeurons, 1000 + i);
        const Recollection a = shard.Recollect(query), b = Recollect(whole, query, pool);
        if (a.answers != b.answers || a.winner != b.winner || a.confidence != b.confidence) {
          return 2;
        }
      }
      return 0;
    });
    EXPECT_EQ(codes, std::vector<int>(static_cast<std::size_t>(ranks), 0));
  }
}

TEST(Shard, AKilledRankIsAnErrorInTheOthersNotAHang) {
  const testing::ScratchFolder folder;
  const auto file = folder / "ranks";
  const auto codes = RunRanks(2, [&](int rank) {
    const Memory slice = Slice(50 * rank, 50 * rank + 50);
    ThreadPool pool(1);
    Shard shard(slice, pool, {.rendezvous = file, .rank = rank, .ranks = 2});
    const auto query = RandomPattern(kNeurons, 7);
    const Stopwatch watch;
    try {
      shard.Recollect(query);
      // The other may still be at the end of this round when the kill comes: that counts as well.
      if (rank == 1) raise(SIGKILL);
      shard.Recollect(query);
    } catch (const Error& error) {
      return watch.Seconds() < 10 ? 5 : 6;
    }
    return 7;
  });
  EXPECT_EQ(codes, (std::vector<int>{5, -1}));
}

TEST(Shard, ARankThatStaysAwayIsAnErrorAfterTheTimeOut) {
  const testing::ScratchFolder folder;
  const auto file = folder / "ranks";
  const auto codes = RunRanks(1, [&](int) {
    const Memory slice = Slice(0, 5);
    ThreadPool pool(1);
    try {
      Shard shard(slice, pool, {.rendezvous = file, .rank = 0, .ranks = 2, .timeout_s = 0.5});
    } catch (const Error&) {
      return 5;
    }
    return 6;
  });
  EXPECT_EQ(codes, std::vector<int>{5});
}

}  // namespace
}  // namespace recollect::wnn
