#include "recollect/geometry/camera.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "recollect/core/error.h"

namespace recollect {
namespace {

const PinholeCamera kCamera{640, 480, 489.44, 480, 323.5, 237};

TEST(PinholeCamera, ProjectsAndUnprojects) {
  const Eigen::Vector3d p = kCamera.Unproject(100, 200, 7);
  EXPECT_DOUBLE_EQ(p.z(), 7);
  EXPECT_LT((kCamera.Project(p) - Eigen::Vector2d(100, 200)).norm(), 1e-12);
  EXPECT_LT((kCamera.K() * p / p.z() - Eigen::Vector3d(100, 200, 1)).norm(), 1e-12);
}

TEST(PinholeCamera, ContainsItsPixelsToTheirEdges) {
  EXPECT_TRUE(kCamera.Contains({-0.5, -0.5}));
  EXPECT_TRUE(kCamera.Contains({639.4, 479.4}));
  EXPECT_FALSE(kCamera.Contains({639.5, 0}));
  EXPECT_FALSE(kCamera.Contains({0, -0.6}));
}

TEST(PinholeCamera, CropMovesPixels) {
  const PinholeCamera crop = kCamera.Cropped(160, 140, 320, 240);
  const Eigen::Vector3d p(0.3, -0.1, 4);
  EXPECT_LT((crop.Project(p) + Eigen::Vector2d(160, 140) - kCamera.Project(p)).norm(), 1e-12);
  EXPECT_EQ(crop.width, 320);
}

// A pixel's corner keeps its share of the image's width and height.
TEST(PinholeCamera, ResizeScalesAreas) {
  const PinholeCamera small = kCamera.Resized(160, 240);
  const Eigen::Vector3d corner = kCamera.Unproject(-0.5, 479.5, 2);
  EXPECT_LT((small.Project(corner) - Eigen::Vector2d(-0.5, 239.5)).norm(), 1e-12);
  EXPECT_EQ(small.Resized(640, 480), kCamera);
}

// Pixel (i, j) of every second pixel is pixel (2i, 2j).
TEST(PinholeCamera, SubsamplingScalesCentres) {
  const PinholeCamera depth = kCamera.Subsampled(2);
  EXPECT_EQ(depth.width, 320);
  EXPECT_LT((depth.Project(kCamera.Unproject(246, 100, 3)) - Eigen::Vector2d(123, 50)).norm(),
            1e-12);
  EXPECT_EQ((PinholeCamera{5, 7, 1, 1, 0, 0}.Subsampled(2).height), 4);
}

TEST(PinholeCamera, RefusesCropsThatLeaveTheImage) {
  EXPECT_THROW(kCamera.Cropped(-1, 0, 10, 10), Error);
  EXPECT_THROW(kCamera.Cropped(0, 0, 641, 10), Error);
  EXPECT_THROW(kCamera.Cropped(0, 0, 0, 10), Error);
  EXPECT_THROW(kCamera.Resized(0, 10), Error);
  EXPECT_THROW(kCamera.Subsampled(0), Error);
}

TEST(StereoCamera, DepthIsFocalLengthTimesBaselineOverDisparity) {
  EXPECT_DOUBLE_EQ((StereoCamera{kCamera, 0.24}.Depth(10)), 489.44 * 0.024);
}

}  // namespace
}  // namespace recollect
