#include "recollect/dataset/trajectory_io.h"

#include <gtest/gtest.h>

#include "recollect/core/error.h"
#include "recollect/dataset/test_folder.h"

namespace recollect {
namespace {

const std::vector<StampedPose> kPoses = {
    {1472150830.248564, SE3::FromRotationVector({0.1, -2, 1}, {7757729.361956, -363562.193147, 0})},
    {1472150830.311246, SE3::FromRotationVector({0, 3.1, 0}, {1e-7, -1.0 / 3, 1e6})}};

TEST(TrajectoryIo, TumGivesBackWhatWasWritten) {
  const TestFolder folder;
  WriteTumTrajectory(folder.path() / "a.tum", kPoses);
  const Trajectory read = ReadTumTrajectory(folder.path() / "a.tum");
  ASSERT_EQ(read.size(), kPoses.size());
  for (std::size_t i = 0; i < kPoses.size(); ++i) {
    EXPECT_EQ(read.poses()[i].time, kPoses[i].time);
    EXPECT_EQ(read.poses()[i].world_from_body.translation(),
              kPoses[i].world_from_body.translation());
    EXPECT_LT(
        (read.poses()[i].world_from_body.rotation() - kPoses[i].world_from_body.rotation()).norm(),
        1e-14);
  }
}

TEST(TrajectoryIo, KittiGivesBackWhatWasWritten) {
  const TestFolder folder;
  WriteKittiPoses(folder.path() / "sub/a.txt",
                  {kPoses[0].world_from_body, kPoses[1].world_from_body});
  const std::vector<SE3> read = ReadKittiPoses(folder.path() / "sub/a.txt");
  ASSERT_EQ(read.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read[i].Matrix(), kPoses[i].world_from_body.Matrix());
  }
}

TEST(TrajectoryIo, WritesTheFormatsAsOthersReadThem) {
  const TestFolder folder;
  WriteTumTrajectory(folder.path() / "a.tum", {{1.5, SE3(Eigen::Matrix3d::Identity(), {1, 2, 3})}});
  EXPECT_EQ(folder.Read("a.tum"), "1.5 1 2 3 0 0 0 1\n");
  WriteKittiPoses(folder.path() / "a.txt", {SE3(Eigen::Matrix3d::Identity(), {1, 2, 3})});
  EXPECT_EQ(folder.Read("a.txt"), "1 0 0 1 0 1 0 2 0 0 1 3\n");
}

TEST(TrajectoryIo, RoundedRotationsBecomeRotations) {
  const TestFolder folder;
  folder.Write("a.txt", "0.8 -0.6 0 1 0.6 0.8001 0 2 0 0 1 3\n");
  EXPECT_TRUE(IsRotation(ReadKittiPoses(folder.path() / "a.txt")[0].rotation(), 1e-14));
  folder.Write("a.tum", "0 0 0 0 0 0 0.7071 0.7071\n");
  EXPECT_TRUE(IsRotation(ReadTumTrajectory(folder.path() / "a.tum").At(0).rotation(), 1e-14));
}

}  // namespace
}  // namespace recollect
