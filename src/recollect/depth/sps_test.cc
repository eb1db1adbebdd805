#include "recollect/depth/sps.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <set>
#include <vector>

#include "recollect/core/error.h"
#include "recollect/depth/test_pairs.h"

namespace recollect::stereo {
namespace {

using testing::Pair;

SpsOptions WithSuperpixels(int count) {
  SpsOptions options;
  options.superpixels = count;
  return options;
}
const SpsOptions kSmall = WithSuperpixels(80);

SlantedPlaneResult Smooth(const Pair& pair) {
  ThreadPool pool(1);
  const cv::Mat matched =
      SemiGlobalMatcher({.disparities = 48}, pool).Disparity(pair.left, pair.right);
  return SmoothBySlantedPlanes(pair.left, matched, kSmall);
}

TEST(Sps, GoesOnOverHolesAndOutliersOfASlantedPlane) {
  const Pair pair = testing::Surface(160, 100, [](int x, int y) { return 2 + 0.1 * x + 0.05 * y; });
  cv::Mat given = pair.disparity.clone();
  Random random(1);
  for (int i = 0; i < 1500; ++i) {
    given.at<float>(static_cast<int>(random.Index(100)), static_cast<int>(random.Index(160))) =
        static_cast<float>(random.Uniform(0, 40));
  }
  given(cv::Rect(60, 30, 30, 30)) = kUnknown;
  const SlantedPlaneResult result = SmoothBySlantedPlanes(pair.left, given, kSmall);
  EXPECT_EQ(cv::countNonZero(result.disparity >= 0), 160 * 100);
  EXPECT_GT(testing::Right(result.disparity, pair.disparity, 0.5, {0, 0, 160, 100}), 0.99);
  EXPECT_EQ(cv::countNonZero(result.measured(cv::Rect(61, 31, 28, 28))), 0);
  int coplanar = 0;
  for (const Boundary& b : result.boundaries) coplanar += b.label == BoundaryLabel::kCoplanar;
  EXPECT_GT(coplanar, std::ssize(result.boundaries) * 95 / 100);
}

// No colour says where the box ends, so the superpixels' outlines are ragged there.
TEST(Sps, FillsWhatIsHiddenFromTheWallBehind) {
  const Pair pair = testing::BoxBeforeWall(200, 120, 30, 10, {90, 30, 60, 60});
  const SlantedPlaneResult result = Smooth(pair);
  EXPECT_GT(testing::Right(result.disparity, pair.disparity, 1, {72, 34, 16, 52}), 0.7);
  EXPECT_GT(testing::Right(result.disparity, pair.disparity, 1, {94, 34, 52, 52}), 0.97);
  EXPECT_GT(testing::Right(result.disparity, pair.disparity, 1, {160, 0, 40, 120}), 0.97);
}

TEST(Sps, LabelsTheBoundaryOfABoxAsAnOcclusionByIt) {
  const Pair pair = testing::BoxBeforeWall(200, 120, 30, 10, {90, 30, 60, 60});
  const SlantedPlaneResult result = Smooth(pair);
  // The disparity in the middle of each superpixel's plane tells box from wall.
  std::vector<cv::Point3d> middles(result.planes.size());
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 200; ++x) {
      auto& m = middles[static_cast<std::size_t>(result.labels.at<std::int32_t>(y, x))];
      m += cv::Point3d(x, y, 1);
    }
  }
  const auto is_box = [&](int label) {
    const auto i = static_cast<std::size_t>(label);
    return result.planes[i].At(middles[i].x / middles[i].z, middles[i].y / middles[i].z) > 20;
  };
  int between = 0, right = 0;
  for (const Boundary& b : result.boundaries) {
    if (is_box(b.first) == is_box(b.second)) continue;
    ++between;
    right +=
        b.label == (is_box(b.first) ? BoundaryLabel::kFirstInFront : BoundaryLabel::kSecondInFront);
  }
  EXPECT_GT(between, 10);
  EXPECT_GT(right, between * 8 / 10);
}

TEST(Sps, FindsTheHingeOfTwoPlanes) {
  const Pair pair = testing::Surface(
      160, 100, [](int x, int) { return x < 80 ? 20 - 0.15 * x : 8 + 0.15 * (x - 80); });
  const SlantedPlaneResult result = SmoothBySlantedPlanes(pair.left, pair.disparity, kSmall);
  EXPECT_GT(testing::Right(result.disparity, pair.disparity, 0.6, {0, 0, 160, 100}), 0.9);
  for (const Boundary& b : result.boundaries) {
    EXPECT_TRUE(b.label == BoundaryLabel::kCoplanar || b.label == BoundaryLabel::kHinge);
  }
}

TEST(Sps, SuperpixelsStayInOnePiece) {
  const Pair pair = testing::BoxBeforeWall(120, 90, 20, 6, {50, 30, 40, 30});
  const cv::Mat labels = Smooth(pair).labels;
  std::set<int> seen;
  for (int y = 0; y < labels.rows; ++y) {
    for (int x = 0; x < labels.cols; ++x) seen.insert(labels.at<std::int32_t>(y, x));
  }
  for (const int label : seen) {
    cv::Mat parts;
    EXPECT_EQ(cv::connectedComponents(labels == label, parts, 4), 2) << label;
  }
  EXPECT_GT(seen.size(), 60U);
  EXPECT_EQ(*seen.rbegin() + 1, static_cast<int>(seen.size()));
}

TEST(Sps, RefusesWhatItCannotSmooth) {
  const cv::Mat image(30, 40, CV_8U, cv::Scalar(9)), none(30, 40, CV_32F, cv::Scalar(kUnknown));
  EXPECT_THROW(SmoothBySlantedPlanes(image, none), Error);
  EXPECT_THROW(SmoothBySlantedPlanes(image, cv::Mat::zeros(20, 40, CV_32F)), Error);
  EXPECT_THROW(SmoothBySlantedPlanes(image, cv::Mat::zeros(30, 40, CV_32F), WithSuperpixels(0)),
               Error);
}

}  // namespace
}  // namespace recollect::stereo
