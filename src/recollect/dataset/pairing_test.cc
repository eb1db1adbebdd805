#include "recollect/dataset/pairing.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <numbers>

#include "recollect/dataset/reader.h"
#include "recollect/geometry/frames.h"

namespace recollect {
namespace {

// Frames along x at the given places, the camera half a metre ahead of the car.
Lap Drive(const std::vector<double>& xs, double yaw = 0) {
  Lap lap;
  lap.body_forward = Eigen::Vector3d::UnitX();
  lap.world_up = Eigen::Vector3d::UnitZ();
  lap.body_from_camera = VehicleFromCamera({0.5, 0, 0}, 0, 0, 0);
  for (const double x : xs) {
    lap.frames.emplace_back().world_from_body = SE3(RotationFromRollPitchYaw(0, 0, yaw), {x, 0, 0});
  }
  return lap;
}

using Pairs = std::vector<FramePair>;

TEST(PairsWithin, GivesAllPairsInOrder) {
  EXPECT_EQ(PairsWithin(Drive({0, 10}), Drive({-3, 1, 4, 11}), 3, 0.1),
            (Pairs{{0, 0}, {0, 1}, {1, 3}}));
  const Lap lap = Drive({0, 2});
  EXPECT_EQ(PairsWithin(lap, lap, 2, 0.1), (Pairs{{0, 0}, {0, 1}, {1, 0}, {1, 1}}));
}

TEST(PairsWithin, KeepsWorldsApart) {
  Lap elsewhere = Drive({0, 2});
  elsewhere.world = 1;
  EXPECT_TRUE(PairsWithin(Drive({0, 2}), elsewhere, 2, 0.1).empty());
  EXPECT_EQ(PairsWithin(elsewhere, elsewhere, 2, 0.1).size(), 4u);
}

TEST(PairsWithin, MeasuresFromCameraToCamera) {
  const double half_turn = std::numbers::pi;
  EXPECT_EQ(PairsWithin(Drive({0}), Drive({1}, half_turn), 0.1, half_turn + 0.1).size(), 1u);
  EXPECT_TRUE(PairsWithin(Drive({0}), Drive({1}, half_turn), 0.1, half_turn - 0.1).empty());
}

TEST(PairAlongRoute, DropsPairsTooFarApartAndNearlyTheSame) {
  // From each live frame to the key frame: 0.5, 4.2, 7 (along 10), and 1.5 the other way.
  const Lap key = Drive({0, 17}), live = Drive({0.5, 4.2, 10, 15.5});
  EXPECT_EQ(PairAlongRoute(live, key, false), (Pairs{{1, 0}, {3, 1}}));
  EXPECT_EQ(PairAlongRoute(live, key, true), (Pairs{{0, 0}, {1, 0}, {3, 1}}));
  EXPECT_TRUE(PairAlongRoute(live, Drive({0, 17}, std::numbers::pi), false).empty());
}

TEST(PairsWithin, CountsEveryPairOfTheTorcsLaps) {
  const std::filesystem::path data = RECOLLECT_SHARED_DATA "/torcs-wheel";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << data << " is missing";
  const std::vector<Lap> laps = ReadLaps(data);
  ASSERT_EQ(laps.size(), 4u);
  std::size_t pairs = 0, identical = 0;
  for (int live = 0; live < 3; ++live) {
    for (int key = 0; key < 3; ++key) {
      for (const FramePair& pair : PairsWithin(laps[live], laps[key], 5, std::numbers::pi / 2)) {
        ++pairs;
        if (live == key && pair.live == pair.key) ++identical;
      }
    }
  }
  EXPECT_EQ(pairs, 38512u);
  EXPECT_EQ(identical, 1320u);
}

}  // namespace
}  // namespace recollect
