#include "recollect/dataset/sampling.h"

#include <gtest/gtest.h>

#include "recollect/core/error.h"
#include "recollect/geometry/frames.h"

namespace recollect {
namespace {

struct Stop {
  double x, yaw;
};

Lap Drive(const std::vector<Stop>& stops) {
  Lap lap;
  lap.body_forward = Eigen::Vector3d::UnitX();
  lap.world_up = Eigen::Vector3d::UnitZ();
  for (const auto& [x, yaw] : stops) {
    lap.frames.emplace_back().world_from_body = SE3(RotationFromRollPitchYaw(0, 0, yaw), {x, 0, 0});
  }
  return lap;
}

using Frames = std::vector<std::size_t>;

TEST(SampleFrames, KeepsFramesFarFromTheLastKept) {
  const Lap lap = Drive({{0, 0}, {0.9, 0}, {1, 0}, {1.5, 0}, {2.5, 0}, {2.6, 0}, {3.5, 0}});
  EXPECT_EQ(SampleFrames(lap, 1), (Frames{0, 2, 4, 6}));
  EXPECT_EQ(SampleFrames(lap, 0).size(), lap.frames.size());
  EXPECT_EQ(SampleFrames(lap, 100), (Frames{0}));
}

TEST(SampleFrames, KeepsFramesThatTurned) {
  const Lap lap = Drive({{0, 0}, {0, 0.1}, {0, 0.18}, {0, 0.3}, {0, 0.36}});
  EXPECT_EQ(SampleFrames(lap, 1), (Frames{0, 2, 4}));  // 10 degrees are 0.1745
  EXPECT_EQ(SampleFrames(lap, 1, 0.29), (Frames{0, 3}));
}

TEST(SampleFrames, TakesTheShortWayRoundUnlessAsPublished) {
  const Lap lap = Drive({{0, 3.13}, {0, -3.13}, {0, -3.12}});
  EXPECT_EQ(SampleFrames(lap, 1), (Frames{0}));
  EXPECT_EQ(SampleFrames(lap, 1, 0.2, YawRule::kAsPublished), (Frames{0, 1}));
}

TEST(SampleFrames, OfNothingIsNothing) { EXPECT_TRUE(SampleFrames(Lap{}, 1).empty()); }

TEST(SampleFrames, RefusesWrongOptions) {
  EXPECT_THROW(SampleFrames(Lap{}, -1), Error);
  EXPECT_THROW(SampleFrames(Lap{}, 1, 0), Error);
  EXPECT_THROW(SampleFrames(Lap{}, 1, 1, YawRule::kAsPublished), Error);  // z up is not known
}

}  // namespace
}  // namespace recollect
