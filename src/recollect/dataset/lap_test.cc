#include "recollect/dataset/lap.h"

#include <gtest/gtest.h>

#include <numbers>

#include "recollect/core/error.h"
#include "recollect/geometry/frames.h"

namespace recollect {
namespace {

Lap CarLap() {
  Lap lap;
  lap.body_forward = Eigen::Vector3d::UnitX();
  lap.world_up = Eigen::Vector3d::UnitZ();
  lap.frames.resize(2);
  lap.frames[0].world_from_body = SE3(RotationFromRollPitchYaw(0.2, -0.3, 3.0), {0, 0, 0});
  lap.frames[1].world_from_body = SE3(RotationFromRollPitchYaw(-0.1, 0.2, -3.0), {0, 0, 0});
  return lap;
}

TEST(Heading, DiffersByYawWhereUpIsKnown) {
  const Lap lap = CarLap();
  EXPECT_LT((Heading(lap, 0) - Eigen::Vector3d(std::cos(3.0), std::sin(3.0), 0)).norm(), 1e-15);
  EXPECT_NEAR(HeadingDifference(Heading(lap, 0), Heading(lap, 1)), 2 * std::numbers::pi - 6, 1e-14);
}

TEST(Heading, IsWhereTheCameraLooksWhereUpIsNot) {
  Lap lap;
  lap.frames.resize(2);
  lap.frames[1].world_from_body = SE3(ExpSo3({0, 0.5, 0}), {0, 0, 0});  // y is down: to the right
  EXPECT_EQ(Heading(lap, 0), Eigen::Vector3d::UnitZ());
  EXPECT_NEAR(HeadingDifference(Heading(lap, 0), Heading(lap, 1)), 0.5, 1e-15);
}

TEST(Heading, DifferenceReachesAHalfTurn) {
  EXPECT_DOUBLE_EQ(HeadingDifference(Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitX()),
                   std::numbers::pi);
}

TEST(Lap, SubsetKeepsTheFramesAskedFor) {
  Lap lap = CarLap();
  lap.frames[1].time = 7;
  lap.gps.push_back({1, {1, 2, 3}, 4});
  const Lap subset = Subset(lap, {1});
  ASSERT_EQ(subset.frames.size(), 1u);
  EXPECT_EQ(subset.frames[0].time, 7);
  EXPECT_EQ(subset.gps.size(), 1u);
}

TEST(Lap, HasALength) {
  Lap lap = CarLap();
  lap.frames[1].world_from_body = SE3(Eigen::Matrix3d::Identity(), {3, 4, 0});
  EXPECT_DOUBLE_EQ(PathLength(lap), 5);
}

TEST(NearestFix, IsNearestInTime) {
  Lap lap;
  EXPECT_EQ(NearestFix(lap, 0), nullptr);
  for (const double time : {1.0, 2.0, 4.0}) lap.gps.push_back({time, Eigen::Vector3d::Zero(), 4});
  EXPECT_EQ(NearestFix(lap, -5)->time, 1);
  EXPECT_EQ(NearestFix(lap, 1.4)->time, 1);
  EXPECT_EQ(NearestFix(lap, 1.6)->time, 2);
  EXPECT_EQ(NearestFix(lap, 4)->time, 4);
  EXPECT_EQ(NearestFix(lap, 9)->time, 4);
}

TEST(DepthCamera, IsTheImagesOrAWholeFraction) {
  const PinholeCamera camera{640, 481, 500, 500, 320, 240};
  EXPECT_EQ(DepthCamera(camera, 640, 481), camera);
  EXPECT_EQ(DepthCamera(camera, 320, 241), camera.Subsampled(2));
  EXPECT_EQ(DepthCamera(camera, 160, 121), camera.Subsampled(4));
  EXPECT_THROW(DepthCamera(camera, 320, 240), Error);
  EXPECT_THROW(DepthCamera(camera, 1280, 962), Error);
  EXPECT_THROW(DepthCamera(camera, 0, 0), Error);
}

}  // namespace
}  // namespace recollect
