#include "recollect/evaluation/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "recollect/core/error.h"

namespace recollect {
namespace {

TEST(Statistics, AgreeWithValuesWorkedOutByHand) {
  const Summary s = Summarise({4, 1, 3, 2, 10});
  EXPECT_EQ(s.count, 5u);
  EXPECT_DOUBLE_EQ(s.mean, 4);
  EXPECT_DOUBLE_EQ(s.median, 3);
  EXPECT_DOUBLE_EQ(s.p75, 4);
  EXPECT_DOUBLE_EQ(s.p95, 8.8);  // between 4 and 10, at 0.95 * 4 = 3.8
  EXPECT_DOUBLE_EQ(s.max, 10);
  EXPECT_DOUBLE_EQ(Quantile({1, 2}, 0.5), 1.5);
}

TEST(Box, ReachesToTheLastValuesThatAreNoOutliers) {
  const Box box = BoxOf({0, 10, 11, 12, 13, 14, 30});
  EXPECT_DOUBLE_EQ(box.q1, 10.5);
  EXPECT_DOUBLE_EQ(box.median, 12);
  EXPECT_DOUBLE_EQ(box.q3, 13.5);
  EXPECT_DOUBLE_EQ(box.low, 10);  // 10.5 - 1.5 * 3 = 6: 0 is beyond, 10 the last within
  EXPECT_DOUBLE_EQ(box.high, 14);
  EXPECT_EQ(BoxOf({}).high, 0);
}

TEST(Statistics, OfNothingAreZeroAndOfNaNAnError) {
  EXPECT_EQ(Summarise({}).count, 0u);
  EXPECT_EQ(Quantile({}, 0.5), 0);
  EXPECT_THROW(Summarise({1, std::nan("")}), Error);
  EXPECT_THROW(Quantile({1}, 1.5), Error);
}

}  // namespace
}  // namespace recollect
