#include "recollect/geometry/trajectory.h"

#include <gtest/gtest.h>

#include "recollect/core/error.h"

namespace recollect {
namespace {

const Trajectory kTrajectory({{10, SE3::FromRotationVector({0, 0, 0}, {0, 0, 0})},
                              {12, SE3::FromRotationVector({0, 0, 1}, {4, 0, 0})},
                              {13, SE3::FromRotationVector({0, 0, 1}, {4, 3, 0})}});

TEST(Trajectory, InterpolatesByTime) {
  const SE3 pose = kTrajectory.At(10.5);
  EXPECT_LT((pose.translation() - Eigen::Vector3d(1, 0, 0)).norm(), 1e-15);
  EXPECT_LT((pose.RotationVector() - Eigen::Vector3d(0, 0, 0.25)).norm(), 1e-15);
  EXPECT_EQ(kTrajectory.At(10).translation(), Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(kTrajectory.At(12).translation(), Eigen::Vector3d(4, 0, 0));
  EXPECT_EQ(kTrajectory.At(13).translation(), Eigen::Vector3d(4, 3, 0));
}

TEST(Trajectory, HasALength) { EXPECT_DOUBLE_EQ(kTrajectory.Length(), 7); }

TEST(Trajectory, RefusesTimesOutsideOfIt) {
  EXPECT_TRUE(kTrajectory.Covers(13));
  EXPECT_FALSE(kTrajectory.Covers(13.001));
  EXPECT_THROW(kTrajectory.At(9.999), Error);
  EXPECT_THROW(kTrajectory.At(13.001), Error);
  EXPECT_THROW(Trajectory().At(0), Error);
}

TEST(Trajectory, RefusesTimesOutOfOrder) {
  EXPECT_THROW(Trajectory({{1, SE3()}, {1, SE3()}}), Error);
  EXPECT_THROW(Trajectory({{2, SE3()}, {1, SE3()}}), Error);
}

}  // namespace
}  // namespace recollect
