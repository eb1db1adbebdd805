#include "recollect/wnn/search.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/wnn/test_patterns.h"

namespace recollect::wnn {
namespace {

TEST(Search, EveryNeuronAnswersWithItsNearestEntry) {
  const int neurons = 33, entries = 150;
  Memory memory(neurons);
  for (int i = 0; i < entries; ++i) {
    memory.Append(RandomPattern(neurons, static_cast<std::uint64_t>(i)));
  }
  const auto query = RandomPattern(neurons, 1000);
  ThreadPool pool(2);
  const Recollection r = Recollect(memory, query, pool);
  EXPECT_EQ(r.neurons_read, neurons);
  for (std::size_t n = 0; n < neurons; ++n) {
    int nearest = 129;
    std::vector<int> distances;
    for (int e = 0; e < entries; ++e) {
      const auto pattern = memory.Pattern(e);
      distances.push_back(std::popcount(pattern[2 * n] ^ query[2 * n]) +
                          std::popcount(pattern[2 * n + 1] ^ query[2 * n + 1]));
      nearest = std::min(nearest, distances.back());
    }
    EXPECT_EQ(AnswerDistance(r.answers[n]), nearest);
    EXPECT_EQ(distances[static_cast<std::size_t>(AnswerEntry(r.answers[n]))], nearest);
  }
}

TEST(Search, RecollectsItsOwnFramesWithAllVotes) {
  Memory memory(50);
  for (int i = 0; i < 70; ++i) memory.Append(RandomPattern(50, static_cast<std::uint64_t>(i)));
  ThreadPool pool(2);
  for (const int entry : {0, 63, 64, 69}) {
    const Recollection r = Recollect(memory, memory.Pattern(entry), pool);
    EXPECT_EQ(r.winner, entry);
    EXPECT_EQ(r.histogram[0].votes, 50);
    EXPECT_EQ(r.confidence, 1);
  }
}

// Every entry equally near for every neuron: each must be chosen equally often. Chi-square with
// 99 degrees of freedom exceeds 160 with a chance of about 1e-4; any bias fails on some seed.
TEST(Search, BreaksTiesUniformly) {
  const int neurons = 5000, entries = 100;
  Memory memory(neurons);
  const auto same = RandomPattern(neurons, 3);
  for (int i = 0; i < entries; ++i) memory.Append(same);
  ThreadPool pool(2);
  for (const std::uint64_t seed : {1, 2, 3}) {
    std::vector<int> votes(entries, 0);
    for (const LabelVotes& v : Recollect(memory, same, pool, {.tie_seed = seed}).histogram) {
      votes[static_cast<std::size_t>(v.label)] = v.votes;
    }
    double chi_square = 0;
    for (const int v : votes) chi_square += (v - 50.0) * (v - 50.0) / 50.0;
    EXPECT_LT(chi_square, 160);
    EXPECT_GT(chi_square, 50);  // random, not dealt out in turn
  }
}

TEST(Search, DiceDependOnSeedImageAndNeuron) {
  const int neurons = 2000;
  Memory memory(neurons);
  auto pattern = RandomPattern(neurons, 3);
  for (int i = 0; i < 2; ++i) memory.Append(pattern);
  ThreadPool pool(2);
  const auto a = Recollect(memory, pattern, pool).answers;
  EXPECT_EQ(Recollect(memory, pattern, pool).answers, a);
  pattern[0] ^= 1;  // another image, the same for all neurons but the first
  for (const auto& b : {Recollect(memory, memory.Pattern(0), pool, {.tie_seed = 2}).answers,
                        Recollect(memory, pattern, pool).answers}) {
    int same = 0;
    for (std::size_t n = 0; n < a.size(); ++n) same += AnswerEntry(a[n]) == AnswerEntry(b[n]);
    EXPECT_NEAR(same, neurons / 2.0, 5 * std::sqrt(neurons / 4.0));
  }
}

TEST(Search, SameAnswerWithAnyNumberOfThreadsAndAnyBlocks) {
  const int neurons = 700, entries = 100;
  Memory whole(neurons), cut(neurons);
  std::vector<std::vector<std::uint64_t>> blocks;
  for (int i = 0; i < entries; ++i) {
    auto pattern = RandomPattern(neurons, static_cast<std::uint64_t>(i));
    for (auto& word : pattern) word &= 0x0101010101010101;  // many ties
    whole.Append(pattern);
    blocks.emplace_back(BlockWords(neurons, 8));
    StoreFrame(pattern, 0, 8, blocks.back().data());
    cut.AddBlock({blocks.back().data(), 1, 8});
  }
  auto query = RandomPattern(neurons, 5000);
  for (auto& word : query) word &= 0x0101010101010101;
  ThreadPool one(1), three(3);
  const auto expected = Recollect(whole, query, one);
  for (const auto& r : {Recollect(whole, query, three), Recollect(cut, query, three)}) {
    EXPECT_EQ(r.answers, expected.answers);
    EXPECT_EQ(r.winner, expected.winner);
    EXPECT_EQ(r.confidence, expected.confidence);
  }
}

TEST(Search, EmptyMemoryAndForeignPatterns) {
  ThreadPool pool(1);
  EXPECT_EQ(Recollect(Memory(4), RandomPattern(4, 1), pool).winner, -1);
  EXPECT_THROW(Recollect(Memory(4), RandomPattern(5, 1), pool), Error);
}

}  // namespace
}  // namespace recollect::wnn
