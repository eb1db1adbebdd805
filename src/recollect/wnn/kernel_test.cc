// Every kernel against the plain one: the same answers, to the bit, on random and on nasty input.
#include "recollect/wnn/kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <string>
#include <tuple>

#include "recollect/wnn/bit_square.h"
#include "recollect/wnn/test_patterns.h"

namespace recollect::wnn {
namespace {

using Words = std::vector<std::uint64_t>;

// What words of memory and query look like.
enum class Content { kRandom, kFewBits, kAllEqual, kNearQuery, kExtremes };

Words Fill(std::size_t count, Content content, std::uint64_t seed) {
  Words words(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t bits = SubSeed(seed, i);
    switch (content) {
      case Content::kRandom:
        words[i] = bits;
        break;
      case Content::kFewBits:
        words[i] = bits & 0x8000000000000001;
        break;  // ties everywhere
      case Content::kAllEqual:
        words[i] = 0x123456789abcdef0;
        break;
      case Content::kNearQuery:
        words[i] = 0x5555555555555555 ^ (std::uint64_t{1} << (bits % 64));
        break;
      case Content::kExtremes:
        words[i] = bits % 2 ? ~std::uint64_t{0} : 0;
        break;
    }
  }
  return words;
}

struct Case {
  int neurons, capacity, queries, begin, end;
  std::uint64_t allowed;
  Content content;
};

// Two blocks, so that the second meets answers of the first. Returns the distances computed.
std::int64_t ExpectSame(const Kernel& kernel, const Case& c, std::uint64_t seed) {
  const auto row = static_cast<std::size_t>(c.neurons) * static_cast<std::size_t>(c.capacity);
  const Words words = Fill(4 * row, c.content, seed);
  const auto words_of_query = static_cast<std::size_t>(c.neurons) * kWords;
  const Words patterns =
      Fill(words_of_query * static_cast<std::size_t>(c.queries), c.content, ~seed);
  enum class How { kOneByOne, kBatch, kEntryByEntry };
  const auto scan = [&](const Kernel& k, How how) {
    std::vector<Answer> answers(static_cast<std::size_t>(c.neurons * c.queries), kNoAnswer);
    std::vector<ScanQuery> queries;
    for (int q = 0; q < c.queries; ++q) {
      const std::uint64_t* pattern = &patterns[words_of_query * static_cast<std::size_t>(q)];
      queries.push_back({pattern, TieBreak(seed, {pattern, words_of_query}),
                         &answers[static_cast<std::size_t>(c.neurons * q)]});
    }
    for (int b = 0; b < 2; ++b) {
      const std::uint64_t* low = words.data() + 2 * b * static_cast<std::ptrdiff_t>(row);
      const ScanBlock block = {low, low + row, c.capacity, 1000 * b, c.allowed};
      if (how == How::kBatch) {
        k.scan_batch(block, queries.data(), c.queries, c.begin, c.end);
        continue;
      }
      for (const ScanQuery& query : queries) {
        if (how == How::kOneByOne) {
          k.scan(block, query, c.begin, c.end);
          continue;
        }
        for (int i = 0; i < c.capacity; ++i) {
          if ((c.allowed >> i & 1) == 0) continue;
          k.probe({low + i, low + row + i, c.capacity, 1000 * b + i}, query, c.begin, c.end);
        }
      }
    }
    return answers;
  };
  const auto expected = scan(kPlainKernel, How::kOneByOne);
  EXPECT_EQ(scan(kernel, How::kOneByOne), expected) << kernel.name << " seed " << seed;
  EXPECT_EQ(scan(kernel, How::kBatch), expected) << kernel.name << " batch, seed " << seed;
  if (c.neurons < 10) {  // slow, and one loop for all kernels
    EXPECT_EQ(scan(kernel, How::kEntryByEntry), expected) << kernel.name << " probe, seed " << seed;
  }
  return std::int64_t{2} * 2 * c.queries * (c.end - c.begin) * std::popcount(c.allowed);
}

TEST(Kernel, EveryOneAgreesWithThePlainOneOnAllTails) {
  for (const Kernel* kernel : Kernels()) {
    SCOPED_TRACE(std::string(kernel->name));
    std::uint64_t seed = 0;
    for (const Content content : {Content::kRandom, Content::kFewBits, Content::kAllEqual,
                                  Content::kNearQuery, Content::kExtremes}) {
      for (const int capacity : {8, 16, 24, 56, 64}) {
        for (int frames = 1; frames <= capacity; ++frames) {
          const std::uint64_t first = ~std::uint64_t{0} >> (64 - frames);
          ++seed;
          ExpectSame(*kernel, {5, capacity, 2, 1, 5, first, content}, seed);
          ExpectSame(*kernel, {3, capacity, 1, 0, 3, first & Scramble(seed), content}, seed);
        }
      }
      for (int queries = 1; queries <= 17; ++queries) {
        ExpectSame(*kernel, {4, 64, queries, 0, 4, ~std::uint64_t{0}, content}, seed);
      }
    }
  }
}

TEST(Kernel, EveryOneAgreesOverAHundredMillionDistances) {
  for (const Kernel* kernel : Kernels()) {
    SCOPED_TRACE(std::string(kernel->name));
    std::int64_t distances = 0;
    for (std::uint64_t seed = 0; distances < 100'000'000; ++seed) {
      const Content content = seed % 4 == 3 ? Content::kFewBits : Content::kRandom;
      const int neurons = 1000, queries = 1 + static_cast<int>(seed % 16);
      distances +=
          ExpectSame(*kernel, {neurons, 64, queries, 0, neurons, ~std::uint64_t{0}, content}, seed);
      if (HasFailure()) break;
    }
  }
}

TEST(Kernel, CellsAgreeWithThePlainOnes) {
  const int neurons = 301, pixels = 5000;
  std::vector<std::int32_t> values, offsets;
  for (std::uint64_t i = 0; i < pixels; ++i) {
    values.push_back(static_cast<std::int32_t>(SubSeed(1, i) & (i % 2 ? 3 : 0xffffff)));
  }
  for (std::uint64_t i = 0; i < neurons * kSynapses; ++i) {
    offsets.push_back(static_cast<std::int32_t>(SubSeed(2, i) % pixels));
  }
  const auto cells = [&](const Kernel& kernel) {
    Words pattern(neurons * kWords, 7);
    kernel.cells(values.data(), offsets.data(), 1, neurons, pattern.data());
    return pattern;
  };
  for (const Kernel* kernel : Kernels()) EXPECT_EQ(cells(*kernel), cells(kPlainKernel));
}

TEST(Kernel, SkipsHalfOfThePatternsOnlyWhereTheOtherHalfRulesThemOut) {
  const Words words = Fill(2 * 64, Content::kRandom, 1);
  const Words pattern = {words[3], words[64 + 3]};  // frame 3 itself
  for (const Kernel* kernel : Kernels()) {
    std::vector<Answer> answer = {MakeAnswer(1, 0, 99)};
    const ScanBlock block = {words.data(), words.data() + 64, 64, 0, ~std::uint64_t{0}};
    const std::int64_t read =
        kernel->scan(block, {pattern.data(), TieBreak(1, pattern), answer.data()}, 0, 1);
    EXPECT_EQ(AnswerEntry(answer[0]), 3) << kernel->name;
    EXPECT_EQ(AnswerDistance(answer[0]), 0);
    EXPECT_LE(read, kernel == &kPlainKernel ? 128 : 64 + 8);
  }
}

TEST(Kernel, CloserLooksAgreeWithThePlainOnes) {
  for (const Content content : {Content::kRandom, Content::kFewBits, Content::kNearQuery}) {
    for (int count = 1; count <= 140; ++count) {
      const auto seed = static_cast<std::uint64_t>(count);
      const Words words = Fill(2 * static_cast<std::size_t>(count), content, seed);
      const Words entries = Fill(kWords, content, ~seed);
      const NeuronViews views{words.data(), words.data() + count, count};
      const auto look = [&](const Kernel& kernel, int limit) {
        Words near(static_cast<std::size_t>(count + 63) / 64 + 1, 7);
        const bool any = kernel.find_near(views, entries.data(), limit, near.data());
        return std::tuple(near, any);
      };
      for (const Kernel* kernel : Kernels()) {
        for (const int limit : {0, 1, 2, 60, 64, 128}) {
          ASSERT_EQ(look(*kernel, limit), look(kPlainKernel, limit)) << kernel->name;
        }
      }
      const auto [near, any] = look(kPlainKernel, 128);
      EXPECT_EQ(near.back(), 7U);
      EXPECT_EQ(std::popcount(near.front()), std::min(count, 64));
      EXPECT_FALSE(std::get<1>(look(kPlainKernel, -1)));
    }
  }
}

TEST(Kernel, DisplacedScansAreScansUnderEachDisplacement) {
  constexpr int kNeurons = 5;
  for (const Content content : {Content::kRandom, Content::kFewBits, Content::kNearQuery}) {
    for (const int capacity : {8, 16, 24, 56, 64}) {
      for (int count = 1; count <= 46; count += 5) {
        const auto seed = static_cast<std::uint64_t>(100 * capacity + count);
        const Words block_words =
            Fill(std::size_t{2} * kNeurons * static_cast<std::size_t>(capacity), content, seed);
        const Words live =
            Fill(kWords * kNeurons * static_cast<std::size_t>(count), content, ~seed);
        const std::uint64_t* low = block_words.data();
        const TieBreak ties(seed, live);
        const std::uint64_t all = ~std::uint64_t{0} >> (64 - capacity);
        for (const std::uint64_t allowed : {all, all & Scramble(seed), all >> (capacity / 2 + 1)}) {
          const ScanBlock block{low, low + kNeurons * capacity, capacity, 300, allowed};
          std::vector<Answer> expected(kNeurons, kNoAnswer);
          for (int d = 0; d < count; ++d) {
            Words pattern;
            for (std::size_t i = 0; i < kWords * kNeurons; ++i) {
              pattern.push_back(
                  live[i * static_cast<std::size_t>(count) + static_cast<std::size_t>(d)]);
            }
            kPlainKernel.scan(block, {pattern.data(), ties, expected.data()}, 1, kNeurons);
          }
          for (const Kernel* kernel : Kernels()) {
            std::vector<Answer> answers(kNeurons, kNoAnswer);
            const DisplacedQuery query{live.data(), count, ties, answers.data()};
            kernel->scan_displaced(block, query, 1, kNeurons);
            ASSERT_EQ(answers, expected) << kernel->name << " " << capacity << " " << count;
            kernel->scan_displaced(block, query, 1, kNeurons);
            ASSERT_EQ(answers, expected) << kernel->name << ", twice";
          }
        }
      }
    }
  }
}

TEST(Kernel, MeasuresAgreeWithThePlainOnes) {
  for (const Content content : {Content::kRandom, Content::kFewBits, Content::kExtremes}) {
    for (int count = 1; count <= 70; ++count) {
      const auto seed = static_cast<std::uint64_t>(count), size = seed;
      const int displacements = 1 + 7 * count % 46;
      const Words words = Fill(2 * static_cast<std::size_t>(displacements), content, seed);
      const Words low = Fill(size, content, ~seed), high = Fill(size, content, 3 * seed);
      const auto measure = [&](const Kernel& kernel) {
        Distances all{5, 6};
        Words least(size + 1, 7);
        kernel.measure(ViewsOf(words), low.data(), high.data(), count, all, least.data());
        return std::tuple(all.sum, all.squares, least);
      };
      for (const Kernel* kernel : Kernels()) {
        ASSERT_EQ(measure(*kernel), measure(kPlainKernel)) << kernel->name << " " << count;
      }
      const auto [sum, squares, least] = measure(kPlainKernel);
      std::uint64_t expected = 5, nearest = 128;
      for (std::size_t e = 0; e < size; ++e) {
        for (std::size_t d = 0; d < words.size() / 2; ++d) {
          const auto distance =
              static_cast<std::uint64_t>(std::popcount(words[d] ^ low[e]) +
                                         std::popcount(words[words.size() / 2 + d] ^ high[e]));
          expected += distance;
          if (e == 0) nearest = std::min(nearest, distance);
        }
      }
      EXPECT_EQ(sum, expected);
      EXPECT_EQ(least.front(), nearest);
      EXPECT_EQ(least.back(), 7U);
    }
  }
}

TEST(Kernel, BitsAreTurned) {
  const Words picture = Fill(64, Content::kRandom, 9);
  std::vector<std::uint8_t> bits, packed;
  for (std::size_t i = 0; i < 64 * 64; ++i) bits.push_back(picture[i / 64] >> (i % 64) & 1);
  PackBits(bits, packed);
  for (int count = 1; count <= kReach; ++count) {
    const auto seed = static_cast<std::uint64_t>(count);
    std::vector<std::int32_t> at;
    for (std::uint64_t r = 0; r < 64; ++r) {
      at.push_back(200 + static_cast<std::int32_t>(SubSeed(seed, r) % 3600));
    }
    at[7] = 200, at[8] = 4096 - count - 200;  // the first and the last that is read
    for (const std::ptrdiff_t moved : {-200, -3, 0, 200}) {
      for (const Kernel* kernel : Kernels()) {
        Words words(static_cast<std::size_t>(count) + 1, 7);
        kernel->turn(packed.data(), at.data(), moved, count, words.data());
        for (std::size_t c = 0; c < static_cast<std::size_t>(count); ++c) {
          std::uint64_t expected = 0;
          for (std::size_t r = 0; r < 64; ++r) {
            const auto bit = static_cast<std::size_t>(at[r] + moved) + c;
            expected |= std::uint64_t{bits[bit]} << r;
          }
          ASSERT_EQ(words[c], expected) << kernel->name << " " << count << " " << c;
        }
        EXPECT_EQ(words.back(), 7U) << kernel->name << " " << count;
      }
    }
  }
}

TEST(Kernel, VotesAreAddedBitByBit) {
  const Words rows = {0x8000000000000001, 0, ~std::uint64_t{0}, 0x123456789abcdef0};
  for (const Kernel* kernel : Kernels()) {
    std::vector<std::int16_t> votes(64 * 5, 10);
    kernel->add_votes(rows.data(), 4, votes.data());
    for (std::size_t i = 0; i < votes.size(); ++i) {
      const bool set = i / 64 < 4 && (rows[i / 64] >> (i % 64) & 1) != 0;
      ASSERT_EQ(votes[i], set ? 11 : 10) << kernel->name << " " << i;
    }
  }
}

}  // namespace
}  // namespace recollect::wnn
