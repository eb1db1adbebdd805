#include <gtest/gtest.h>

#include <filesystem>
#include <numeric>
#include <vector>

#include "recollect/core/error.h"
#include "recollect/core/files.h"
#include "recollect/core/huge_pages.h"
#include "recollect/core/instructions.h"
#include "recollect/core/parallel.h"
#include "recollect/core/random.h"
#include "recollect/testing/scratch_folder.h"

namespace recollect {
namespace {

TEST(Error, SaysWhereWhatAndWhatToDo) {
  const Error error(AtLine("poses.txt", 3), "11 numbers where 12 belong", "write 3x4 rows");
  EXPECT_STREQ(error.what(), "poses.txt:3: 11 numbers where 12 belong; write 3x4 rows");
  EXPECT_STREQ(Error("a", "b").what(), "a: b");
}

TEST(Instructions, KeepsTheTablesThatThisMachineRunsInOrder) {
  EXPECT_TRUE(Runs(Instructions::kPlain));
  EXPECT_FALSE(Runs(Instructions::kNeon) && Runs(Instructions::kAvx2));
  EXPECT_FALSE(Runs(Instructions::kAvx512Popcount) && !Runs(Instructions::kAvx512));
  EXPECT_FALSE(Runs(Instructions::kAvx512) && !Runs(Instructions::kAvx2));
  const int fast = 1, wide = 2, plain = 3;
  std::vector<const int*> expected = {&plain, &fast};
  if (Runs(Instructions::kAvx2)) expected.insert(expected.begin(), &wide);
  EXPECT_EQ(Runnable<int>({{Instructions::kAvx2, &wide},
                           {Instructions::kPlain, nullptr},
                           {Instructions::kPlain, &plain},
                           {Instructions::kPlain, &fast}}),
            expected);
}

TEST(PageVector, KeepsItsValuesAndBeginsWithAPage) {
  for (const std::size_t count : {std::size_t{1}, std::size_t{5000}, std::size_t{1} << 21}) {
    PageVector<int> values(count, 7);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(values.data()) % 4096, 0U);
    values.front() = 1;
    values.back() = 2;
    values.resize(2 * count, 3);  // into other pages
    const PageVector<int> copy = values;
    EXPECT_EQ(copy.front(), count > 1 ? 1 : 2);
    EXPECT_EQ(copy[count - 1], 2);
    EXPECT_EQ(copy[count], 3);
    EXPECT_EQ(copy.back(), 3);
  }
}

TEST(ThreadPool, CoversEveryIndexOnceWithAnyThreadsAndGrain) {
  for (const int threads : {1, 2, 5}) {
    ThreadPool pool(threads);
    for (const std::int64_t count : {0, 1, 7, 1000}) {
      for (const std::int64_t grain : {1, 3, 5000}) {
        std::vector<int> visits(static_cast<std::size_t>(count), 0);
        pool.For(count, grain, [&](std::int64_t begin, std::int64_t end) {
          for (std::int64_t i = begin; i < end; ++i) ++visits[static_cast<std::size_t>(i)];
        });
        EXPECT_EQ(std::accumulate(visits.begin(), visits.end(), 0), count);
        for (const int visit : visits) EXPECT_EQ(visit, 1);
      }
    }
  }
}

TEST(ThreadPool, RethrowsAndStaysUsable) {
  ThreadPool pool(3);
  EXPECT_THROW(pool.For(100, 1,
                        [](std::int64_t i, std::int64_t) {
                          if (i == 50) throw Error("here", "on purpose");
                        }),
               Error);
  std::atomic<int> sum{0};
  pool.For(10, 1, [&](std::int64_t i, std::int64_t) { sum += static_cast<int>(i); });
  EXPECT_EQ(sum, 45);
}

TEST(AtomicWrite, ReplacesWholeFilesOrLeavesTheOldOne) {
  namespace fs = std::filesystem;
  const testing::ScratchFolder folder;
  const fs::path file = folder / "deep" / "figures.json";
  AtomicWrite(file, "one");
  AtomicWrite(file, "two");
  EXPECT_EQ(ReadFile(file), "two");
  EXPECT_THROW(AtomicWrite(file,
                           [](const fs::path& temporary) {
                             AtomicWrite(temporary, "half");
                             throw Error("disk", "full");
                           }),
               Error);
  EXPECT_EQ(ReadFile(file), "two");
  EXPECT_EQ(std::distance(fs::directory_iterator(file.parent_path()), fs::directory_iterator()), 1);
  EXPECT_THROW(AtomicWrite(file.parent_path(), "x"), Error);
  EXPECT_THROW(AtomicWrite("/proc/recollect/x", "x"), Error);
  EXPECT_THROW(ReadFile(folder.path()), Error);
  EXPECT_THROW(ReadFile(folder / "missing"), Error);
}

TEST(Random, IsReproducibleAndHasTheRightMoments) {
  Random a(7), b(7), c(8);
  EXPECT_EQ(a.Bits(), b.Bits());
  EXPECT_NE(a.Bits(), c.Bits());
  double sum = 0, squares = 0, uniform = 0;
  const int n = 100000;
  for (int i = 0; i < n; ++i) {
    const double x = a.Normal();
    sum += x;
    squares += x * x;
    uniform += a.Uniform();
  }
  EXPECT_NEAR(sum / n, 0.0, 0.02);
  EXPECT_NEAR(squares / n, 1.0, 0.03);
  EXPECT_NEAR(uniform / n, 0.5, 0.01);
}

}  // namespace
}  // namespace recollect
