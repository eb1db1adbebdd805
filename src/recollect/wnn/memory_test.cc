#include "recollect/wnn/memory.h"

#include <gtest/gtest.h>

#include "recollect/core/error.h"
#include "recollect/wnn/test_patterns.h"

namespace recollect::wnn {
namespace {

constexpr int kNeurons = 5;

TEST(Memory, GivesBackWhatWasAppendedAcrossBlocks) {
  Memory memory(kNeurons);
  for (int i = 0; i < 200; ++i) {
    EXPECT_EQ(memory.Append(RandomPattern(kNeurons, static_cast<std::uint64_t>(i))), i);
  }
  EXPECT_EQ(memory.entries(), 200);
  EXPECT_EQ(memory.blocks().size(), 4u);
  EXPECT_EQ(memory.labels(), 200);
  for (int i = 0; i < 200; ++i) {
    EXPECT_EQ(memory.Pattern(i), RandomPattern(kNeurons, static_cast<std::uint64_t>(i)));
    EXPECT_EQ(memory.label(i), i);
    EXPECT_EQ(memory.BlockOf(i), static_cast<std::size_t>(i / 64));
  }
}

TEST(Memory, SearchesBlocksOfOthersInPlaceAndNumbersOn) {
  std::vector<std::uint64_t> words(BlockWords(kNeurons, 8));
  for (int i = 0; i < 3; ++i) {
    StoreFrame(RandomPattern(kNeurons, static_cast<std::uint64_t>(i)), i, 8, words.data());
  }
  Memory memory(kNeurons);
  memory.Append(RandomPattern(kNeurons, 100), 7);
  memory.AddBlock({words.data(), 3, 8}, std::vector<int>{4, 4, 2});
  memory.Append(RandomPattern(kNeurons, 101));
  memory.AddBlock({words.data(), 2, 8});
  EXPECT_EQ(memory.entries(), 7);
  EXPECT_EQ(memory.labels(), 8);
  EXPECT_EQ(memory.blocks()[1].words, words.data());
  EXPECT_EQ(memory.EntriesOf(4), (std::vector<int>{4, 2, 1}));
  EXPECT_EQ(memory.EntriesOf(3), std::vector<int>{});
  EXPECT_EQ(memory.EntriesOf(8), std::vector<int>{});
  const std::vector<int> labels = {7, 4, 4, 2, 4, 5, 6};
  const std::vector<std::uint64_t> seeds = {100, 0, 1, 2, 101, 0, 1};
  for (int i = 0; i < 7; ++i) {
    EXPECT_EQ(memory.label(i), labels[static_cast<std::size_t>(i)]);
    EXPECT_EQ(memory.Pattern(i), RandomPattern(kNeurons, seeds[static_cast<std::size_t>(i)]));
  }
}

TEST(Memory, RefusesWhatDoesNotFit) {
  EXPECT_THROW(Memory(0), Error);
  Memory memory(kNeurons);
  EXPECT_THROW(memory.Append(RandomPattern(kNeurons + 1, 1)), Error);
  EXPECT_THROW(memory.Append(RandomPattern(kNeurons, 1), -1), Error);
  std::vector<std::uint64_t> words(BlockWords(kNeurons));
  EXPECT_THROW(memory.AddBlock({words.data(), 9, 8}), Error);
  EXPECT_THROW(memory.AddBlock({words.data(), 3, 12}), Error);
  EXPECT_THROW(memory.AddBlock({words.data(), 3, 128}), Error);
  EXPECT_THROW(memory.AddBlock({nullptr, 3, 8}), Error);
  EXPECT_THROW(memory.AddBlock({words.data(), 3, 8}, std::vector<int>{1, 2}), Error);
  EXPECT_THROW(memory.AddBlock({words.data(), 2, 8}, std::vector<int>{1, -2}), Error);
  EXPECT_EQ(memory.entries(), 0);
  EXPECT_THROW(memory.Pattern(0), Error);
}

}  // namespace
}  // namespace recollect::wnn
