#include "recollect/wnn/compressed.h"

#include <gtest/gtest.h>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/wnn/test_patterns.h"

namespace recollect::wnn {
namespace {

constexpr int kNeurons = 40;

std::vector<std::uint64_t> NearTo(std::uint64_t place, std::uint64_t image) {
  auto pattern = RandomPattern(kNeurons, place);
  for (std::size_t w = 0; w < pattern.size(); ++w) {
    pattern[w] ^= std::uint64_t{1} << (SubSeed(image, w) % 64);
  }
  return pattern;
}

// Ten places seen ten times each: ten medoids are enough to know every place.
TEST(CompressedMemory, KeepsOnePatternOfEachClusterWithItsLabel) {
  Memory memory(kNeurons);
  for (std::uint64_t i = 0; i < 100; ++i) {
    memory.Append(NearTo(i % 10, 1000 + i), static_cast<int>(i % 10));
  }
  ThreadPool pool(2);
  const CompressedMemory small(memory, pool, {.medoids = 20});
  EXPECT_EQ(small.memory().entries(), 20);
  for (std::uint64_t place = 0; place < 10; ++place) {
    const Recollection r = small.Recollect(NearTo(place, 5000 + place), pool);
    EXPECT_EQ(r.winner, static_cast<int>(place));
    EXPECT_GT(r.histogram[0].votes, kNeurons * 3 / 4);
  }
}

TEST(CompressedMemory, KeepingAllChangesNoDistance) {
  Memory memory(kNeurons);
  for (std::uint64_t i = 0; i < 30; ++i) memory.Append(RandomPattern(kNeurons, i));
  ThreadPool pool(2), one(1);
  const CompressedMemory all(memory, pool, {.medoids = 30}), again(memory, one, {.medoids = 30});
  const auto query = RandomPattern(kNeurons, 77);
  const Recollection a = all.Recollect(query, pool), b = Recollect(memory, query, pool);
  for (std::size_t n = 0; n < kNeurons; ++n) {
    EXPECT_EQ(AnswerDistance(a.answers[n]), AnswerDistance(b.answers[n]));
  }
  EXPECT_EQ(again.Recollect(query, one).answers, a.answers);
  EXPECT_THROW(CompressedMemory(memory, pool, {.medoids = 31}), Error);
  EXPECT_THROW(CompressedMemory(memory, pool, {.medoids = 0}), Error);
}

}  // namespace
}  // namespace recollect::wnn
