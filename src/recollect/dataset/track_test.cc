#include "recollect/dataset/track.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

namespace recollect {
namespace {

// A track along x, heading along +x.
Track Straight(const std::vector<double>& xs, double y = 0) {
  Track track;
  for (const double x : xs) {
    track.positions.emplace_back(x, y, 0);
    track.headings.emplace_back(1, 0, 0);
  }
  return track;
}

TEST(ArcLengths, CountFromTheStartAndGoRound) {
  const Track square = {{{0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 3, 0}},
                        std::vector<Eigen::Vector3d>(4, Eigen::Vector3d::UnitX()),
                        {}};
  EXPECT_EQ(ArcLengths(square, 0), (std::vector<double>{0, 2, 5, 7}));
  EXPECT_EQ(ArcLengths(square, 2), (std::vector<double>{5, 7, 0, 2}));
  EXPECT_TRUE(ArcLengths(Track{}, 0).empty());
}

TEST(CommonStart, IsWhereTheLiveTrackPassesTheFirstKeyFrame) {
  // Live frame 3 is the first past the key frame at 2.2; frame 2, at 2, is nearest until then.
  EXPECT_EQ(CommonStart(Straight({0, 1, 2, 3, 4}, 0.5), Straight({2.2, 7})), (FramePair{2, 0}));
}

TEST(CommonStart, IsTheNearestPairWhereTheTracksStayApart) {
  EXPECT_EQ(CommonStart(Straight({0, 1, 2, 3}, 20), Straight({2.2, 7})), (FramePair{2, 0}));
}

TEST(CommonStart, IsNoneFarAwayOrOncoming) {
  EXPECT_EQ(CommonStart(Straight({0, 1}, 40), Straight({0})), std::nullopt);
  EXPECT_EQ(CommonStart(Straight({0, 1}), Track{}), std::nullopt);
  Track oncoming = Straight({0, 1});
  for (Eigen::Vector3d& heading : oncoming.headings) heading = -heading;
  EXPECT_EQ(CommonStart(oncoming, Straight({0})), std::nullopt);
}

TEST(MatchAlongRoute, TakesTheNearestKeyFrame) {
  const Track live = Straight({0, 1, 2, 3, 4, 5, 30}), key = Straight({0, 5}, 1);
  const std::vector<FramePair> expected = {{0, 0}, {1, 0}, {2, 0}, {3, 1}, {4, 1}, {5, 1}};
  EXPECT_EQ(MatchAlongRoute(live, key, {0, 0}, 10, 10), expected);
}

// Where the route passes one place twice, the arc length tells which pass it is: the second key
// frame is as near by air, but 20 m further along.
TEST(MatchAlongRoute, KeepsPassesApart) {
  const Track key = Straight({0, 10, 0});
  const Track live = Straight({0, 5, 10, 5, 0.1});
  const std::vector<FramePair> matches = MatchAlongRoute(live, key, {0, 0}, 4, 4);
  ASSERT_EQ(matches.size(), 3u);
  EXPECT_EQ(matches[0], (FramePair{0, 0}));
  EXPECT_EQ(matches[1], (FramePair{2, 1}));
  EXPECT_EQ(matches[2], (FramePair{4, 2}));
}

TEST(MakeTrack, HoldsYawsOnlyAsPublished) {
  Lap lap;
  lap.body_forward = Eigen::Vector3d::UnitX();
  lap.world_up = Eigen::Vector3d::UnitZ();
  lap.frames.resize(2);
  lap.frames[0].world_from_body = SE3(ExpSo3({0, 0, 3}), {1, 2, 3});
  lap.frames[1].world_from_body = SE3(ExpSo3({0, 0, -3}), {1, 2, 3});
  const Track plain = MakeTrack(lap), published = MakeTrack(lap, YawRule::kAsPublished);
  EXPECT_NEAR(HeadingDifference(plain, 0, plain, 1), 2 * std::numbers::pi - 6, 1e-14);
  EXPECT_NEAR(HeadingDifference(published, 0, published, 1), 6, 1e-14);
  EXPECT_EQ(plain.positions[0], Eigen::Vector3d(1, 2, 3));
}

}  // namespace
}  // namespace recollect
