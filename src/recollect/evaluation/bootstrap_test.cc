#include "recollect/evaluation/bootstrap.h"

#include <gtest/gtest.h>

#include <cmath>

#include "recollect/core/error.h"
#include "recollect/core/random.h"

namespace recollect {
namespace {

TEST(Bootstrap, OfEqualValuesIsThatValue) {
  const std::vector<double> values(30, 0.25);
  std::vector<int> block;
  for (int i = 0; i < 30; ++i) block.push_back(i / 5);
  const Interval i = Bootstrap(values, block, Mean);
  EXPECT_EQ(i.value, 0.25);
  EXPECT_EQ(i.low, 0.25);
  EXPECT_EQ(i.high, 0.25);
}

// Two blocks, one of zeros and one of ones: a resample's mean is 0, 1/2 or 1, with probabilities
// 1/4, 1/2 and 1/4, so the interval is all of [0, 1] however many images the blocks hold. Single
// images drawn would give 0.5 +- 0.03.
TEST(Bootstrap, DrawsBlocksAndNotImages) {
  std::vector<double> values(1000, 0.0);
  std::vector<int> block(1000, 7);
  for (std::size_t i = 500; i < 1000; ++i) {
    values[i] = 1;
    block[i] = 3;
  }
  const Interval i = Bootstrap(values, block, Mean);
  EXPECT_EQ(i.value, 0.5);
  EXPECT_EQ(i.low, 0);
  EXPECT_EQ(i.high, 1);
}

// The mean of n independent blocks with standard deviation s has an interval of 1.96 s / sqrt(n),
// whatever the number of copies of each value in its block.
TEST(Bootstrap, HasTheWidthThatTheoryGives) {
  Random random(5);
  constexpr int kBlocks = 400, kCopies = 6;
  std::vector<double> values;
  std::vector<int> block;
  double squares = 0, sum = 0;
  for (int b = 0; b < kBlocks; ++b) {
    const double value = 3 + 2 * random.Normal();
    sum += value;
    squares += value * value;
    values.insert(values.end(), kCopies, value);
    block.insert(block.end(), kCopies, b);
  }
  const double deviation = std::sqrt(squares / kBlocks - std::pow(sum / kBlocks, 2));
  const double expected = 1.96 * deviation / std::sqrt(kBlocks);
  const Interval i = Bootstrap(values, block, Mean, {.resamples = 4000});
  EXPECT_NEAR((i.high - i.low) / 2, expected, 0.05 * expected);
  EXPECT_NEAR(i.value, sum / kBlocks, 1e-9);
}

TEST(Bootstrap, IsTheSameForTheSameSeed) {
  const std::vector<double> values = {1, 5, 2, 8, 3, 9};
  const std::vector<int> block = {0, 0, 1, 1, 2, 2};
  const Interval a = Bootstrap(values, block, Mean), b = Bootstrap(values, block, Mean);
  EXPECT_EQ(a.low, b.low);
  EXPECT_EQ(a.high, b.high);
  EXPECT_LT(a.low, a.value);
}

TEST(Bootstrap, OneBlockTellsNothing) {
  const Interval i = Bootstrap(std::vector<double>{1, 2}, std::vector<int>{4, 4}, Mean);
  EXPECT_EQ(i.low, 1.5);
  EXPECT_EQ(i.high, 1.5);
}

TEST(Bootstrap, RefusesWhatCannotBeDrawn) {
  const std::vector<double> values = {1, 2};
  EXPECT_THROW(Bootstrap({}, {}, Mean), Error);
  EXPECT_THROW(Bootstrap(values, std::vector<int>{1}, Mean), Error);
  EXPECT_THROW(Bootstrap(values, std::vector<int>{1, 2}, Mean, {.resamples = 0}), Error);
  EXPECT_THROW(Bootstrap(values, std::vector<int>{1, 2}, Mean, {.level = 1}), Error);
}

TEST(RouteSegments, AreStretchesOfRoad) {
  const std::vector<Eigen::Vector3d> positions = {{0, 0, 0}, {3, 4, 0}, {3, 4, 1}, {3, 8, 1}};
  const std::vector<double> distance = DistanceAlong(positions);
  EXPECT_EQ(distance, (std::vector<double>{0, 5, 6, 10}));
  EXPECT_EQ(RouteSegments(distance, 5), (std::vector<int>{0, 1, 1, 2}));
  EXPECT_THROW(RouteSegments(distance, 0), Error);
}

}  // namespace
}  // namespace recollect
