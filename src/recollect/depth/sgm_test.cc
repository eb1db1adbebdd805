#include "recollect/depth/sgm.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "recollect/core/error.h"
#include "recollect/depth/kernel.h"
#include "recollect/depth/test_pairs.h"

namespace recollect::stereo {
namespace {

using testing::Pair;

bool Same(const cv::Mat& a, const cv::Mat& b) { return cv::countNonZero(a != b) == 0; }

cv::Mat Match(const Pair& pair, const SgmOptions& options = {.disparities = 48}, int threads = 1,
              const Kernel* kernel = nullptr) {
  ThreadPool pool(threads);
  return SemiGlobalMatcher(options, pool, kernel).Disparity(pair.left, pair.right);
}

TEST(Sgm, FindsAPlaneExactly) {
  const Pair pair = testing::Surface(120, 60, [](int, int) { return 11; });
  EXPECT_GT(testing::Right(Match(pair), pair.disparity, 0.1, {20, 3, 97, 54}), 0.99);
}

TEST(Sgm, FindsASlantedPlaneBelowAPixel) {
  const Pair pair = testing::Surface(160, 80, [](int x, int y) { return 4 + 0.08 * x + 0.05 * y; });
  const cv::Mat disparity = Match(pair);
  EXPECT_GT(testing::Right(disparity, pair.disparity, 1, {30, 3, 125, 74}), 0.97);
  EXPECT_GT(testing::Right(disparity, pair.disparity, 0.3, {30, 3, 125, 74}), 0.75);
}

TEST(Sgm, KnowsNothingOfWhatTheRightCameraDoesNotSee) {
  const Pair pair = testing::BoxBeforeWall(200, 80, 30, 10, {90, 20, 50, 40});
  const cv::Mat disparity = Match(pair);
  EXPECT_GT(testing::Right(disparity, pair.disparity, 1, {96, 26, 38, 28}), 0.98);  // the box
  EXPECT_GT(testing::Right(disparity, pair.disparity, 1, {150, 5, 45, 70}), 0.98);  // the wall
  const cv::Mat hidden = disparity(cv::Rect(74, 26, 12, 28));
  EXPECT_GT(cv::countNonZero(hidden < 0), static_cast<int>(hidden.total()) * 7 / 10);
  EXPECT_EQ(cv::countNonZero(disparity(cv::Rect(0, 0, 8, 80)) >= 0), 0);  // outside the right image
}

TEST(Sgm, GivesTheSameBitsForAnyThreadsAndKernel) {
  const Pair pair = testing::BoxBeforeWall(131, 77, 30, 7, {60, 20, 40, 30});
  for (const int disparities : {16, 48, 112}) {
    const SgmOptions options{.disparities = disparities};
    const cv::Mat expected = Match(pair, options, 1, &kPlainKernel);
    for (const Kernel* kernel : Kernels()) {
      for (const int threads : {1, 2, 5}) {
        EXPECT_TRUE(Same(Match(pair, options, threads, kernel), expected)) << kernel->name;
      }
    }
  }
}

TEST(Sgm, KeepsNothingFromThePairBefore) {
  ThreadPool pool(2);
  SemiGlobalMatcher matcher({.disparities = 32}, pool);
  const Pair first = testing::Surface(90, 40, [](int, int) { return 20; });
  const Pair second = testing::Surface(70, 50, [](int, int) { return 6; });
  matcher.Disparity(first.left, first.right);
  EXPECT_TRUE(
      Same(matcher.Disparity(second.left, second.right), Match(second, {.disparities = 32})));
}

TEST(Sgm, RefusesOptionsAndImagesThatDoNotFit) {
  ThreadPool pool(1);
  for (const SgmOptions& bad :
       {SgmOptions{.disparities = 20}, SgmOptions{.disparities = 272}, SgmOptions{.disparities = 0},
        SgmOptions{.small_penalty = 200, .large_penalty = 100}, SgmOptions{.large_penalty = 9000},
        SgmOptions{.consistency = -2}, SgmOptions{.speckle_size = -1}}) {
    EXPECT_THROW(SemiGlobalMatcher(bad, pool), Error);
  }
  SemiGlobalMatcher matcher({}, pool);
  const cv::Mat image(20, 30, CV_8U, cv::Scalar(0));
  EXPECT_THROW(matcher.Disparity(image, image(cv::Rect(0, 0, 20, 20))), Error);
  EXPECT_THROW(matcher.Disparity(image(cv::Rect(0, 0, 4, 20)), image(cv::Rect(0, 0, 4, 20))),
               Error);
  EXPECT_THROW(matcher.Disparity(cv::Mat(20, 30, CV_16U, cv::Scalar(0)), image), Error);
}

}  // namespace
}  // namespace recollect::stereo
