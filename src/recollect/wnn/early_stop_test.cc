// Searches that do not ask everyone: certain and confident stops, sets of allowed entries, batches.
#include <gtest/gtest.h>

#include <utility>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/wnn/kernel.h"
#include "recollect/wnn/search.h"
#include "recollect/wnn/test_patterns.h"

namespace recollect::wnn {
namespace {

constexpr int kNeurons = 900;

// A road: each frame changes some bits of the one before, so that neighbours resemble each other.
Memory Road(int entries, std::vector<std::vector<std::uint64_t>>* patterns) {
  Memory memory(kNeurons);
  auto pattern = RandomPattern(kNeurons, 1);
  for (int i = 0; i < entries; ++i) {
    for (std::size_t w = 0; w < pattern.size(); ++w) {
      const std::uint64_t dice = SubSeed(static_cast<std::uint64_t>(i) + 2, w);
      pattern[w] ^= std::uint64_t{1} << (dice & 63) | std::uint64_t{1} << (dice >> 6 & 63);
    }
    memory.Append(pattern);
    patterns->push_back(pattern);
  }
  return memory;
}

std::vector<std::uint64_t> Noisy(std::vector<std::uint64_t> pattern, std::uint64_t seed) {
  for (std::size_t w = 0; w < pattern.size(); ++w) {
    if (SubSeed(seed, w) % 3 == 0) pattern[w] ^= SubSeed(~seed, w) & SubSeed(seed ^ 99, w);
  }
  return pattern;
}

TEST(EarlyStop, CertainEqualsTheFullCommitteeAndReadsLess) {
  std::vector<std::vector<std::uint64_t>> patterns;
  const Memory memory = Road(300, &patterns);
  ThreadPool pool(2), one(1);
  double read = 0;
  for (std::uint64_t i = 0; i < 100; ++i) {
    const auto query = Noisy(patterns[3 * i], i);
    const Recollection full = Recollect(memory, query, pool);
    const Recollection early = Recollect(memory, query, pool, {.stop = Stop::kCertain});
    EXPECT_EQ(early.winner, full.winner);
    read += early.neurons_read / (100.0 * kNeurons);
    for (std::size_t n = 0; n < kNeurons; ++n) {
      ASSERT_TRUE(early.answers[n] == kNoAnswer || early.answers[n] == full.answers[n]);
    }
    EXPECT_EQ(Recollect(memory, query, one, {.stop = Stop::kCertain}).answers, early.answers);
  }
  EXPECT_LT(read, 0.8);
}

// Labels of several entries, few labels, and sets of allowed entries go through the same bounds.
TEST(EarlyStop, CertainEqualsTheFullCommitteeWithLabelsAndEntrySets) {
  std::vector<std::vector<std::uint64_t>> patterns;
  Road(300, &patterns);
  ThreadPool pool(2);
  for (const int labels : {1, 2, 7, 60}) {
    Memory memory(kNeurons);
    for (int i = 0; i < 300; ++i) {
      memory.Append(patterns[static_cast<std::size_t>(i)],
                    static_cast<int>(Scramble(static_cast<std::uint64_t>(i)) %
                                     static_cast<std::uint64_t>(labels)));
    }
    EntrySet window(memory);
    window.AllowRange(30, 90).AllowRange(200, 205);
    for (const EntrySet* allowed :
         {static_cast<const EntrySet*>(nullptr), &std::as_const(window)}) {
      for (std::uint64_t i = 0; i < 30; ++i) {
        const auto query = Noisy(patterns[10 * i], i);
        const auto full = Recollect(memory, query, pool, {.allowed = allowed});
        const auto early =
            Recollect(memory, query, pool, {.stop = Stop::kCertain, .allowed = allowed});
        ASSERT_EQ(early.winner, full.winner);
        for (std::size_t n = 0; n < kNeurons; ++n) {
          ASSERT_TRUE(early.answers[n] == kNoAnswer || early.answers[n] == full.answers[n]);
        }
      }
    }
  }
}

TEST(EarlyStop, ConfidentReadsFarLessAndAgrees) {
  std::vector<std::vector<std::uint64_t>> patterns;
  const Memory memory = Road(300, &patterns);
  ThreadPool pool(2);
  double read = 0;
  for (std::uint64_t i = 0; i < 100; ++i) {
    const auto query = Noisy(patterns[3 * i], i);
    const Recollection early = Recollect(memory, query, pool, {.stop = Stop::kConfident});
    EXPECT_EQ(early.winner, Recollect(memory, query, pool).winner);
    read += early.neurons_read / (100.0 * kNeurons);
  }
  EXPECT_LT(read, 0.5);
}

TEST(EntrySet, SearchSeesTheAllowedEntriesOnlyAndReadsInProportion) {
  std::vector<std::vector<std::uint64_t>> patterns;
  const Memory memory = Road(300, &patterns);
  Memory window(kNeurons);
  for (int i = 100; i < 150; ++i) window.Append(patterns[static_cast<std::size_t>(i)], i);
  EntrySet allowed(memory);
  allowed.AllowRange(100, 150);
  EXPECT_EQ(allowed.size(), 50);
  ThreadPool pool(2);
  for (const int at : {20, 120, 280}) {
    const auto query = Noisy(patterns[static_cast<std::size_t>(at)], 5);
    const auto few = Recollect(memory, query, pool, {.allowed = &allowed});
    const auto alone = Recollect(window, query, pool);
    for (std::size_t n = 0; n < kNeurons; ++n) {
      EXPECT_EQ(AnswerDistance(few.answers[n]), AnswerDistance(alone.answers[n]));
      EXPECT_TRUE(AnswerEntry(few.answers[n]) >= 100 && AnswerEntry(few.answers[n]) < 150);
    }
    EXPECT_LE(few.words_read, std::int64_t{2} * 8 * 8 * kNeurons);
  }
  EntrySet all(memory);
  for (int i = 299; i >= 0; --i) all.Allow(i);
  EXPECT_EQ(Recollect(memory, patterns[9], pool, {.allowed = &all}).answers,
            Recollect(memory, patterns[9], pool).answers);
  const EntrySet none(memory);
  EXPECT_EQ(Recollect(memory, patterns[9], pool, {.allowed = &none}).winner, -1);
  EXPECT_THROW(all.Allow(300), Error);
  EXPECT_THROW(all.AllowRange(5, 4), Error);
}

TEST(RecollectBatch, GivesEachImageItsOwnAnswer) {
  std::vector<std::vector<std::uint64_t>> patterns, queries;
  const Memory memory = Road(150, &patterns);
  std::vector<std::span<const std::uint64_t>> views;
  for (std::uint64_t i = 0; i < 37; ++i) queries.push_back(Noisy(patterns[4 * i], i));
  for (const auto& query : queries) views.push_back(query);
  ThreadPool pool(2);
  for (const Kernel* kernel : Kernels()) {
    const auto results = RecollectBatch(memory, views, pool, {.kernel = kernel});
    ASSERT_EQ(results.size(), 37u);
    for (std::size_t i = 0; i < 37; ++i) {
      EXPECT_EQ(results[i].answers, Recollect(memory, queries[i], pool).answers);
    }
  }
}

}  // namespace
}  // namespace recollect::wnn
