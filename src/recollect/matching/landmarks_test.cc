#include "recollect/matching/landmarks.h"

#include <gtest/gtest.h>

#include "recollect/core/error.h"
#include "recollect/core/random.h"
#include "recollect/matching/build_landmarks.h"
#include "recollect/matching/features.h"
#include "recollect/matching/test_descriptors.h"

namespace recollect::matching {
namespace {

const PinholeCamera kCamera{640, 480, 490, 500, 320, 240};

Landmarks Some(int count) {
  Random random(7);
  Landmarks landmarks;
  for (int i = 0; i < count; ++i) {
    landmarks.points.push_back({{random.Normal(), random.Normal(), random.Uniform(1, 50)},
                                random.Uniform(0.4, 2),
                                random.Uniform(0, 3)});
  }
  landmarks.descriptors = Descriptors(count, random);
  landmarks.sources = {12, 11, 13};
  return landmarks;
}

TEST(Landmarks, ComeBackFromBytesWithinTheBudget) {
  const Landmarks some = Some(LandmarkOptions{}.count);
  const auto bytes = ToBytes(some);
  EXPECT_LE(bytes.size(), 60000u);
  const Landmarks back = LandmarksFromBytes(bytes, "test");
  ASSERT_EQ(back.size(), some.size());
  EXPECT_EQ(back.descriptors, some.descriptors);
  EXPECT_EQ(back.sources, some.sources);
  EXPECT_LT((back.points[5].p_keyframe - some.points[5].p_keyframe).norm(), 1e-4);
  EXPECT_NEAR(back.points[5].depth_sigma, some.points[5].depth_sigma, 1e-5);
  EXPECT_EQ(LandmarksFromBytes(ToBytes({}), "empty").size(), 0);
}

TEST(Landmarks, DamagedBytesAreRefusedByName) {
  const auto whole = ToBytes(Some(10));
  for (std::size_t size = 0; size < whole.size(); size += 37) {
    EXPECT_THROW(LandmarksFromBytes(std::span(whole).first(size), "key frame 3"), Error);
  }
  auto huge = whole;
  huge[7] = std::byte{0xff};  // points: more than there is
  EXPECT_THROW(LandmarksFromBytes(huge, "key frame 3"), Error);
  auto foreign = whole;
  foreign[0] = std::byte{0};
  EXPECT_THROW(LandmarksFromBytes(foreign, "key frame 3"), Error);
  auto nan = whole;
  nan[14] = nan[15] = std::byte{0xff};
  try {
    LandmarksFromBytes(nan, "key frame 3");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("key frame 3"), std::string::npos);
  }
}

TEST(Landmarks, CovarianceIsThatOfPixelAndDepth) {
  const Landmark l{kCamera.Unproject(500, 100, 20), 2, 0.7};
  Random random(8);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  constexpr int kDraws = 20000;
  for (int i = 0; i < kDraws; ++i) {
    const Eigen::Vector3d p = kCamera.Unproject(
        500 + 2 * random.Normal(), 100 + 2 * random.Normal(), 20 + 0.7 * random.Normal());
    sum += (p - l.p_keyframe) * (p - l.p_keyframe).transpose() / kDraws;
  }
  EXPECT_LT((sum - l.Covariance(kCamera)).norm(), 0.05 * sum.norm());
}

class Triangulation : public ::testing::Test {
 protected:
  std::vector<Sighting> See(const Eigen::Vector3d& p, double noise) {
    std::vector<Sighting> sightings;
    for (const double z : {-2.5, -1.0, 1.0, 2.5}) {  // the key frame's camera moves ahead
      const SE3 other_from_key =
          SE3::FromRotationVector({0.01 * z, 0.02, 0}, {0.02 * z, 0, z}).Inverse();
      const Eigen::Vector2d n(random_.Normal(), random_.Normal());
      sightings.push_back({other_from_key, kCamera.Project(other_from_key * p) + noise * n, 0.5});
    }
    return sightings;
  }
  Random random_{11};
};

TEST_F(Triangulation, FindsExactDepthWithoutAndWithDepthImage) {
  for (const double depth : {4.0, 11.0, 35.0}) {
    const Eigen::Vector2d pixel(480, 310);
    const auto seen = See(kCamera.Unproject(480, 310, depth), 0);
    EXPECT_NEAR(TriangulateDepth(kCamera, pixel, seen, 0, 0, 1, 150).depth, depth, 1e-3 * depth);
    const auto both = TriangulateDepth(kCamera, pixel, seen, depth, 0.001, 1, 150);
    EXPECT_NEAR(both.depth, depth, 1e-3 * depth);
    EXPECT_EQ(both.supports, 4);
  }
}

TEST_F(Triangulation, ItsSigmaIsThatOfItsErrors) {
  double sum = 0;
  int count = 0;
  for (int i = 0; i < 300; ++i) {
    const auto found = TriangulateDepth(kCamera, {520, 330},
                                        See(kCamera.Unproject(520, 330, 12), 0.5), 0, 0, 1, 150);
    ASSERT_GT(found.depth, 0);
    const double off = (1 / found.depth - 1.0 / 12) / found.inverse_sigma;
    sum += off * off;
    ++count;
  }
  EXPECT_NEAR(sum / count, 1, 0.35);
}

TEST_F(Triangulation, SightingsOverruleADepthImageThatIsWrong) {
  const auto seen = See(kCamera.Unproject(520, 330, 8), 0);
  const auto found = TriangulateDepth(kCamera, {520, 330}, seen, 40, 0.002, 1, 150);
  EXPECT_NEAR(found.depth, 8, 0.4);
}

TEST_F(Triangulation, WhatMovesHasNoSupportAndNothingNoDepth) {
  auto seen = See(kCamera.Unproject(520, 330, 8), 0);
  for (std::size_t i = 0; i < seen.size(); ++i) {  // off the epipolar lines
    seen[i].pixel += Eigen::Vector2d(-30, i % 2 == 0 ? 40 : -40);
  }
  const auto found = TriangulateDepth(kCamera, {520, 330}, seen, 0, 0, 1, 150);
  EXPECT_LE(found.supports, 1);
  EXPECT_EQ(TriangulateDepth(kCamera, {520, 330}, {}, 0, 0, 1, 150).depth, 0);
}

}  // namespace
}  // namespace recollect::matching
