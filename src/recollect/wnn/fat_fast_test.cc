#include "recollect/wnn/fat_fast.h"

#include <gtest/gtest.h>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/wnn/search.h"
#include "recollect/wnn/test_patterns.h"

namespace recollect::wnn {
namespace {

constexpr int kNeurons = 60, kEntries = 400;

Memory Entries() {
  Memory memory(kNeurons);
  for (std::uint64_t i = 0; i < kEntries; ++i) memory.Append(RandomPattern(kNeurons, i));
  return memory;
}

// Entry `entry` with `bits` of each neuron's bits turned.
std::vector<std::uint64_t> Turned(const Memory& memory, int entry, int bits, std::uint64_t seed) {
  auto pattern = memory.Pattern(entry);
  Random random(seed);
  for (std::size_t n = 0; n < kNeurons; ++n) {
    std::uint64_t done[2] = {0, 0};
    for (int b = 0; b < bits;) {
      const auto at = static_cast<std::size_t>(random.Index(128));
      const std::uint64_t bit = std::uint64_t{1} << (at % 64);
      if (done[at / 64] & bit) continue;
      done[at / 64] |= bit;
      pattern[2 * n + at / 64] ^= bit;
      ++b;
    }
  }
  return pattern;
}

TEST(FatFast, FindsTheNearestForSureUpToSevenBitsAway) {
  const Memory memory = Entries();
  ThreadPool pool(2);
  const FatFast fast(memory, pool);
  EXPECT_GE(fast.bytes(), std::size_t{kNeurons} * kEntries * 8 * 6);
  for (std::uint64_t i = 0; i < 20; ++i) {
    const auto query = Turned(memory, static_cast<int>(17 * i), static_cast<int>(i % 8), i);
    EXPECT_EQ(fast.Recollect(query, pool).answers, Recollect(memory, query, pool).answers);
  }
}

TEST(FatFast, ComparesFarFewerPatternsAndSometimesMisses) {
  const Memory memory = Entries();
  ThreadPool pool(2);
  const FatFast fast(memory, pool);
  int same = 0;
  for (std::uint64_t i = 0; i < 20; ++i) {
    const auto query = Turned(memory, static_cast<int>(17 * i), 20, i);
    const Recollection a = fast.Recollect(query, pool), b = Recollect(memory, query, pool);
    EXPECT_LT(a.words_read, 10 * 2 * kNeurons);
    for (std::size_t n = 0; n < kNeurons; ++n) {
      EXPECT_GE(AnswerDistance(a.answers[n]), AnswerDistance(b.answers[n]));
      same += a.answers[n] == b.answers[n];
    }
  }
  // All 8 substrings are hit by 20 turned bits with a chance of about 0.5.
  EXPECT_GT(same, 20 * kNeurons * 0.3);
  EXPECT_LT(same, 20 * kNeurons * 0.9);
}

TEST(FatFast, LimitedRowsKeepThatManyAtRandom) {
  Memory memory(kNeurons);
  const auto same = RandomPattern(kNeurons, 1);
  for (int i = 0; i < 100; ++i) memory.Append(same);
  ThreadPool pool(2);
  const FatFast fast(memory, pool, {.row_limit = 3});
  const Recollection r = fast.Recollect(same, pool);
  EXPECT_EQ(r.words_read, 2 * 8 * 3 * kNeurons);
  EXPECT_GT(r.histogram.size(), 20u);  // not always the same three
  EXPECT_THROW(FatFast(memory, pool, {.row_limit = -1}), Error);
}

TEST(FatFast, NeuronsThatFindNothingAnswerAtRandom) {
  Memory memory(kNeurons);
  const std::vector<std::uint64_t> zeros(2 * kNeurons, 0), ones(2 * kNeurons, ~std::uint64_t{0});
  for (int i = 0; i < 10; ++i) memory.Append(zeros);
  ThreadPool pool(1);
  const Recollection r = FatFast(memory, pool).Recollect(ones, pool);
  EXPECT_EQ(r.neurons_read, kNeurons);
  EXPECT_GT(r.histogram.size(), 5u);
  const Memory empty(kNeurons);
  EXPECT_EQ(FatFast(empty, pool).Recollect(ones, pool).winner, -1);
}

}  // namespace
}  // namespace recollect::wnn
