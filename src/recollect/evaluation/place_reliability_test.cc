#include "recollect/evaluation/place_reliability.h"

#include <gtest/gtest.h>

#include "recollect/core/random.h"

namespace recollect {
namespace {

TEST(PlaceReliability, BinsOfKnownAnswers) {
  // Eight sure answers, one of them wrong, and two that are half sure.
  std::vector<Told> told = {{0.5, true}, {1, false}, {0.54, false}};
  for (int i = 0; i < 7; ++i) told.push_back({0.95, true});
  const auto width = BinsOfEqualWidth(told);
  ASSERT_EQ(width.size(), 2u);
  EXPECT_EQ(width[0].count, 2);
  EXPECT_NEAR(width[0].said, 0.52, 1e-12);
  EXPECT_NEAR(width[0].right, 0.5, 1e-12);
  EXPECT_EQ(width[1].count, 8);
  EXPECT_NEAR(width[1].said, (7 * 0.95 + 1) / 8, 1e-12);
  EXPECT_NEAR(width[1].right, 0.875, 1e-12);

  const auto count = BinsOfEqualCount(told, 5);
  ASSERT_EQ(count.size(), 5u);
  for (const ReliabilityBin& bin : count) EXPECT_EQ(bin.count, 2);
  EXPECT_NEAR(count[0].said, 0.52, 1e-12);
  EXPECT_NEAR(count[4].said, 0.975, 1e-12);
  EXPECT_NEAR(count[4].right, 0.5, 1e-12);
  EXPECT_EQ(BinsOfEqualCount(told, 20).size(), 10u);
  EXPECT_TRUE(BinsOfEqualCount({}).empty());
}

TEST(PlaceReliability, IntervalsAreWilsons) {
  // 8 of 10: 0.490 to 0.943 (Wilson 1927); 10 of 10: 0.722 to 1.
  std::vector<Told> told(10, {0.7, true});
  EXPECT_NEAR(BinsOfEqualCount(told, 1)[0].low, 0.722, 1e-3);
  EXPECT_NEAR(BinsOfEqualCount(told, 1)[0].high, 1, 1e-12);
  told[0].right = told[1].right = false;
  EXPECT_NEAR(BinsOfEqualCount(told, 1)[0].low, 0.490, 1e-3);
  EXPECT_NEAR(BinsOfEqualCount(told, 1)[0].high, 0.943, 1e-3);
}

TEST(PlaceReliability, WhatIsSaidTruthfullyLiesWithinTheIntervals) {
  Random random(3);
  std::vector<Told> told;
  for (int i = 0; i < 20000; ++i) {
    const double p = random.Uniform();
    told.push_back({p, random.Uniform() < p});
  }
  for (const auto& bins : {BinsOfEqualWidth(told), BinsOfEqualCount(told)}) {
    int outside = 0;
    for (const ReliabilityBin& bin : bins) outside += bin.said < bin.low || bin.said > bin.high;
    EXPECT_LE(outside, 2);
  }
}

}  // namespace
}  // namespace recollect
