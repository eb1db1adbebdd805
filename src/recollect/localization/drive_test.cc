#include "recollect/localization/drive.h"

#include <gtest/gtest.h>
#include <filesystem>
#include <numbers>

#include "recollect/core/parallel.h"
#include "recollect/testing/scratch_folder.h"
#include "recollect/testing/street.h"

namespace recollect {
namespace {

namespace fs = std::filesystem;

// A street of 60 m, key frames every 5 m.
class DriveTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const Lap lap = testing::DriveStreet(folder_ / "lap", {.length_m = 60, .seed = 1});
    CreateMap(folder_ / "m.map", std::span(&lap, 1), {}, pool_);
    map_.emplace(Map::Open(folder_ / "m.map"));
  }

  // Of key frame `key`, moved on by so many metres.
  SE3 Beyond(int key, double metres) const {
    return map_->At(key).world_from_camera * SE3(Eigen::Matrix3d::Identity(), {0, 0, metres});
  }

  testing::ScratchFolder folder_;
  ThreadPool pool_{2};
  std::optional<Map> map_;
};

TEST_F(DriveTest, SteadyMotionLeadsToWhereItGoes) {
  Drive drive(*map_, {});
  EXPECT_FALSE(drive.Expected());
  const auto off = [&](const SE3& pose) {
    return (drive.Expected()->world_from_camera.translation() - pose.translation()).norm();
  };
  drive.Learn(Beyond(4, 0));
  EXPECT_NEAR(off(Beyond(4, 0)), 0, 1e-9);  // one pose tells no motion
  drive.Learn(Beyond(4, 1.5));
  EXPECT_NEAR(off(Beyond(4, 3)), 0, 1e-6);
  const double before = drive.Expected()->covariance.trace();
  drive.Learn(std::nullopt);
  EXPECT_NEAR(off(Beyond(4, 4.5)), 0, 1e-6);  // it goes on while images say nothing
  EXPECT_GT(drive.Expected()->covariance.trace(), before);
}

TEST_F(DriveTest, ForgetsAPoseThatNothingConfirms) {
  Drive drive(*map_, {});
  drive.Learn(Beyond(4, 0));
  for (int i = 0; i < 4; ++i) drive.Learn(std::nullopt);
  EXPECT_TRUE(drive.Expected());
  drive.Learn(std::nullopt);
  EXPECT_FALSE(drive.Expected());
  drive.Learn(Beyond(4, 0));
  drive.Reset();
  EXPECT_FALSE(drive.Expected());
}

// An image whose votes favour another place does not move the belief from where the drive has got
// to, as long as it speaks for that as well.
TEST_F(DriveTest, BelievesTheDriveRatherThanOneImage) {
  Drive drive(*map_, {});
  const auto see = [&](std::vector<wnn::LabelVotes> votes) {
    wnn::Recollection recollection;
    recollection.histogram = std::move(votes);
    for (const auto& one : recollection.histogram) recollection.neurons_read += one.votes;
    return drive.Believed(recollection, 8, 5);
  };
  for (const int key : {3, 4, 5, 6, 7}) see({{key, 100}});
  const std::vector<int> keys = see({{1, 60}, {8, 40}});
  ASSERT_FALSE(keys.empty());
  EXPECT_EQ(keys.front(), 8);
}

}  // namespace
}  // namespace recollect
