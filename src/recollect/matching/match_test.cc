#include "recollect/matching/match.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <string>

#include "recollect/core/random.h"
#include "recollect/matching/features.h"
#include "recollect/matching/kernel.h"
#include "recollect/matching/test_descriptors.h"

namespace recollect::matching {
namespace {

TEST(MatchDescriptors, FindsTwinsAndDropsTheDoubtful) {
  Random random(9);
  const auto mapped = Descriptors(40, random);
  auto live = Descriptors(33, random);
  const auto copy = [&](int to, int from) {
    std::copy_n(mapped.begin() + from * kDescriptorBytes, kDescriptorBytes,
                live.begin() + to * kDescriptorBytes);
  };
  copy(3, 20);
  copy(30, 7);
  const auto matches = MatchDescriptors(live.data(), 33, mapped.data(), 40, {0.6});
  ASSERT_EQ(matches.size(), 2u);
  EXPECT_EQ(matches[0].live, 3);
  EXPECT_EQ(matches[0].mapped, 20);
  EXPECT_EQ(matches[1].live, 30);
  EXPECT_EQ(matches[1].mapped, 7);
  // Two live features that look the same: only one may have the landmark.
  copy(4, 20);
  EXPECT_EQ(MatchDescriptors(live.data(), 33, mapped.data(), 40, {0.6}).size(), 2u);
  // Two landmarks that look the same: neither is to be trusted.
  auto doubled = mapped;
  std::copy_n(mapped.begin() + 20 * kDescriptorBytes, kDescriptorBytes, doubled.begin());
  EXPECT_EQ(MatchDescriptors(live.data(), 33, doubled.data(), 40, {0.6}).size(), 1u);
  EXPECT_TRUE(MatchDescriptors(live.data(), 33, nullptr, 0).empty());
}

TEST(Likeness, IsTheInnerProduct) {
  Random random(10);
  const auto d = Descriptors(2, random);
  int sum = 0;
  for (std::size_t k = 0; k < kDescriptorBytes; ++k) sum += d[k] * d[k + kDescriptorBytes];
  EXPECT_EQ(Likeness(d.data(), d.data() + kDescriptorBytes), sum);
}

// By the definition, one pair at a time.
std::vector<Match> Plainly(const std::vector<std::int8_t>& live,
                           const std::vector<std::int8_t>& mapped, double ratio) {
  const int lives = static_cast<int>(live.size()) / kDescriptorBytes;
  const int maps = static_cast<int>(mapped.size()) / kDescriptorBytes;
  const auto squared = [&](int i, int j) {
    int sum = 0;
    for (int k = 0; k < kDescriptorBytes; ++k) {
      const int d = live[static_cast<std::size_t>(i * kDescriptorBytes + k)] -
                    mapped[static_cast<std::size_t>(j * kDescriptorBytes + k)];
      sum += d * d;
    }
    return sum;
  };
  std::vector<Match> matches;
  for (int i = 0; i < lives; ++i) {
    std::vector<std::pair<int, int>> by_distance;
    for (int j = 0; j < maps; ++j) by_distance.emplace_back(squared(i, j), j);
    std::sort(by_distance.begin(), by_distance.end());
    const auto [best, j] = by_distance.front();
    if (best >= ratio * ratio * by_distance[1].first) continue;
    bool mutual = true;
    for (int other = 0; other < lives; ++other) mutual = mutual && squared(other, j) >= best;
    if (mutual) matches.push_back({i, j, 0});
  }
  return matches;
}

TEST(MatchDescriptors, AreThoseOfTheDefinition) {
  Random random(11);
  for (const int count : {2, 15, 16, 17, 100}) {
    const auto mapped = Descriptors(count, random);
    auto live = Descriptors(61, random);
    for (std::size_t i = 0; i < std::min(live.size(), mapped.size()); ++i) {
      if (i / kDescriptorBytes % 2 == 0) {  // every other one is much like a mapped one
        live[i] = static_cast<std::int8_t>(
            std::clamp(mapped[i] + static_cast<int>(random.Index(41)) - 20, 0, 127));
      }
    }
    const auto expected = Plainly(live, mapped, 0.9);
    const auto got = MatchDescriptors(live.data(), 61, mapped.data(), count, {0.9});
    ASSERT_GE(expected.size(), 1u);
    ASSERT_EQ(got.size(), expected.size()) << count;
    for (std::size_t i = 0; i < got.size(); ++i) {
      EXPECT_EQ(got[i].live, expected[i].live);
      EXPECT_EQ(got[i].mapped, expected[i].mapped);
      EXPECT_EQ(got[i].likeness, Likeness(live.data() + got[i].live * kDescriptorBytes,
                                          mapped.data() + got[i].mapped * kDescriptorBytes));
    }
  }
}

TEST(MatchingKernel, GivesThePlainProductsOnAllTails) {
  ASSERT_EQ(Kernels().back(), &kPlainKernel);
  Random random(12);
  for (const Kernel* kernel : Kernels()) {
    for (const int count : {1, 15, 16, 33, 400}) {
      for (int rows = 1; rows <= kernel->rows; ++rows) {
        SCOPED_TRACE(std::string(kernel->name) + " " + std::to_string(rows) + " x " +
                     std::to_string(count));
        auto own = Descriptors(rows, random);
        std::fill_n(own.begin(), kDescriptorBytes, std::int8_t{127});  // the greatest sums
        auto others = Descriptors(count, random);
        std::fill_n(others.begin(), kDescriptorBytes, std::int8_t{127});
        const PackedDescriptors packed(others.data(), count);
        const auto size = static_cast<std::size_t>(rows * packed.padded());
        std::vector<int> got(size + 1, -7);
        kernel->products(own.data(), rows, packed.data(), packed.groups(), got.data());
        EXPECT_EQ(got.back(), -7);
        for (int r = 0; r < rows; ++r) {
          for (int j = 0; j < packed.padded(); ++j) {
            const int expected = j < count ? Likeness(own.data() + r * kDescriptorBytes,
                                                      others.data() + j * kDescriptorBytes)
                                           : 0;
            ASSERT_EQ(got[static_cast<std::size_t>(r * packed.padded() + j)], expected);
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace recollect::matching
