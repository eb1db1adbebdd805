#include "recollect/geometry/frames.h"

#include <gtest/gtest.h>

#include <numbers>

namespace recollect {
namespace {

using Eigen::Vector3d;

TEST(Frames, YawTurnsLeftPitchLowersTheNoseRollLowersTheRightSide) {
  constexpr double kQuarter = std::numbers::pi / 2;
  EXPECT_LT(
      (RotationFromRollPitchYaw(0, 0, kQuarter) * Vector3d::UnitX() - Vector3d::UnitY()).norm(),
      1e-15);
  EXPECT_LT(
      (RotationFromRollPitchYaw(0, kQuarter, 0) * Vector3d::UnitX() + Vector3d::UnitZ()).norm(),
      1e-15);
  EXPECT_LT(
      (RotationFromRollPitchYaw(kQuarter, 0, 0) * Vector3d::UnitY() - Vector3d::UnitZ()).norm(),
      1e-15);
}

// Written out by hand: Rz Ry Rx.
TEST(Frames, RotationIsTheProductOfYawPitchRoll) {
  const double r = 0.1, p = -0.4, y = 2.5;
  const Eigen::Matrix3d R = RotationFromRollPitchYaw(r, p, y);
  EXPECT_NEAR(R(0, 0), std::cos(y) * std::cos(p), 1e-15);
  EXPECT_NEAR(R(1, 0), std::sin(y) * std::cos(p), 1e-15);
  EXPECT_NEAR(R(2, 0), -std::sin(p), 1e-15);
  EXPECT_NEAR(R(2, 1), std::cos(p) * std::sin(r), 1e-15);
  EXPECT_NEAR(R(0, 1), std::cos(y) * std::sin(p) * std::sin(r) - std::sin(y) * std::cos(r), 1e-15);
  EXPECT_LT((RollPitchYaw(R) - Vector3d(r, p, y)).norm(), 1e-15);
}

TEST(Frames, AStraightCameraLooksAhead) {
  const SE3 camera = VehicleFromCamera({1, 2, 3}, 0, 0, 0);
  EXPECT_EQ(camera * Vector3d(0, 0, 10), Vector3d(11, 2, 3));  // in front of it
  EXPECT_EQ(camera * Vector3d(1, 0, 0), Vector3d(1, 1, 3));    // right of it
  EXPECT_EQ(camera * Vector3d(0, 1, 0), Vector3d(1, 2, 2));    // below it
}

TEST(Frames, TheUfesCameraLooksAheadAndALittleDown) {
  const SE3 camera = UfesVehicleFromCamera();
  EXPECT_TRUE(IsRotation(camera.rotation(), 1e-12));
  const Vector3d ahead = camera.rotation() * Vector3d::UnitZ();
  EXPECT_GT(ahead.x(), 0.999);
  EXPECT_NEAR(ahead.z(), -std::sin(0.026), 1e-12);
  EXPECT_NEAR(camera.translation().z(), 1.88, 1e-12);
}

}  // namespace
}  // namespace recollect
