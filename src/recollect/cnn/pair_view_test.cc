#include "recollect/cnn/pair_view.h"

#include <gtest/gtest.h>
#include <torch/torch.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "recollect/cnn/loader.h"
#include "recollect/cnn/test_street.h"

namespace recollect::cnn {
namespace {

const Eigen::Matrix3d kMirror = Eigen::Vector3d(-1, 1, 1).asDiagonal();

// How far a pair is from being of one scene.
struct Mismatch {
  double colour = 0;  // mean difference of the pixels that show one point, of 255
  double depth = 0;   // share of those where the depths differ by more than 7 %
  std::int64_t points = 0;
};

// The crop is not in the middle, so that mirrors must heed the principal point.
class PairViewTest : public ::testing::Test {
 protected:
  static constexpr int kPairs = 6;

  PairViewTest() {
    ThreadPool pool(2);
    data_ = LoadPairs(street_.laps(), street_.laps(), Crop{320, 240, 8, 20, 288, 192},
                      {.max_distance_m = 2}, pool);
  }

  const Pair& Nth(int n) const {
    return data_.pairs[static_cast<std::size_t>(n) * data_.pairs.size() / kPairs];
  }

  // The other way round, for the key frame's depth.
  PairView Swapped(const Pair& pair) const { return ViewOf(data_, {pair.key, pair.live}); }

  static Eigen::Matrix3d Turn(double pitch, double yaw, double roll) {
    constexpr double kDegree = 0.0174533;
    return ExpSo3(kDegree * Eigen::Vector3d(pitch, yaw, roll));
  }

  // The live camera's points with depth, carried into the key frame.
  Mismatch Compare(const PairView& pair, const cv::Mat& key_depth, const SE3& motion) const {
    const PinholeCamera& camera = data_.camera;
    const PinholeCamera grid = camera.Subsampled(kDepthStep);
    cv::Mat live, key;
    cv::blur(pair.live, live, {5, 5});
    cv::blur(pair.key, key, {5, 5});
    Mismatch mismatch;
    for (int v = 0; v < grid.height; ++v) {
      for (int u = 0; u < grid.width; ++u) {
        const double z = pair.live_depth.at<float>(v, u);
        if (z <= 0 || z > 30) continue;
        const Eigen::Vector3d there = motion * grid.Unproject(u, v, z);
        if (there.z() < 0.5) continue;
        const Eigen::Vector2d at = camera.Project(there), cell = grid.Project(there);
        if (!grid.Contains(cell) || !camera.Contains(at)) continue;
        const double known = key_depth.at<float>(static_cast<int>(std::lround(cell.y())),
                                                 static_cast<int>(std::lround(cell.x())));
        if (known <= 0) continue;
        ++mismatch.points;
        if (std::abs(known / there.z() - 1) > 0.07) ++mismatch.depth;
        const auto here = live.at<cv::Vec3b>(v * kDepthStep, u * kDepthStep);
        const auto seen = key.at<cv::Vec3b>(static_cast<int>(std::lround(at.y())),
                                            static_cast<int>(std::lround(at.x())));
        for (int c = 0; c < 3; ++c) mismatch.colour += std::abs(here[c] - seen[c]) / 3.0;
      }
    }
    mismatch.colour /= static_cast<double>(mismatch.points);
    mismatch.depth /= static_cast<double>(mismatch.points);
    return mismatch;
  }

  TestStreet street_{{{.length_m = 7}, {.length_m = 7, .lateral_m = 1, .seed = 2}}};
  PairData data_;
};

// Whatever the cameras' axes, points of the live camera are where the key frame shows them.
TEST_F(PairViewTest, TheTrueMotionJoinsChangedImages) {
  const Eigen::Matrix3d turned_live = Turn(3, -4, 5), turned_key = Turn(-2, 5, -3);
  for (const auto& [live, key] : {std::pair<Eigen::Matrix3d, Eigen::Matrix3d>{kMirror, kMirror},
                                  {turned_live, turned_key},
                                  {turned_live * kMirror, turned_key * kMirror}}) {
    for (int n = 0; n < kPairs; ++n) {
      PairView pair = ViewOf(data_, Nth(n)), back = Swapped(Nth(n));
      const SE3 unchanged = pair.keyframe_from_live;
      const Mismatch before = Compare(pair, back.live_depth, unchanged);
      ChangeView(pair, data_.camera, live, key);
      ChangeView(back, data_.camera, key, live);
      const Mismatch after = Compare(pair, back.live_depth, pair.keyframe_from_live);
      EXPECT_GT(after.points, 1000);
      EXPECT_LT(after.colour, 1.3 * before.colour + 0.5) << n;
      EXPECT_LT(after.depth, before.depth + 0.03) << n;
      EXPECT_TRUE(IsRotation(pair.keyframe_from_live.rotation(), 1e-9));
      const SE3 difference = back.keyframe_from_live * pair.keyframe_from_live;
      EXPECT_LT(difference.Log().norm(), 1e-9);

      const SE3 other_sign(key.transpose() * unchanged.rotation() * live,
                           key.transpose() * unchanged.translation());
      if (live == kMirror) continue;  // which is its own inverse
      EXPECT_GT(Compare(pair, back.live_depth, other_sign).colour, 4 * after.colour) << n;
      EXPECT_GT(Compare(pair, back.live_depth, unchanged).colour, 4 * after.colour) << n;
    }
  }
}

TEST_F(PairViewTest, DepthOfAPlaneIsThatOfTheTurnedPlane) {
  const PinholeCamera grid = data_.camera.Subsampled(kDepthStep);
  const Eigen::Vector3d normal = Eigen::Vector3d(0.3, 0.5, 1).normalized();
  PairView pair = ViewOf(data_, Nth(0));
  pair.live_depth = pair.live_depth.clone();
  for (int v = 0; v < grid.height; ++v) {
    for (int u = 0; u < grid.width; ++u) {
      pair.live_depth.at<float>(v, u) = static_cast<float>(8 / normal.dot(grid.Unproject(u, v, 1)));
    }
  }
  const Eigen::Matrix3d turned = Turn(3, -4, 5);
  ChangeView(pair, data_.camera, turned, turned);
  int seen = 0, unseen = 0;
  for (int v = 0; v < grid.height; ++v) {
    for (int u = 0; u < grid.width; ++u) {
      const double z = pair.live_depth.at<float>(v, u);
      const Eigen::Vector3d ray = grid.Unproject(u, v, 1);
      const Eigen::Vector2d from = grid.Project(turned.transpose() * ray);
      if (from.x() < -0.5 || from.y() < -0.5 || from.x() > grid.width || from.y() > grid.height) {
        EXPECT_EQ(z, 0);
        ++unseen;
      } else if (from.x() >= 0 && from.y() >= 0 && from.x() <= grid.width - 1 &&
                 from.y() <= grid.height - 1) {
        EXPECT_NEAR(z * (turned * normal).dot(ray), 8, 1e-4);
        ++seen;
      }
    }
  }
  EXPECT_GT(seen, 1000);
  EXPECT_GT(unseen, 100);
}

TEST_F(PairViewTest, TwoMirrorsShowTheSame) {
  const PairView before = ViewOf(data_, Nth(1));
  PairView after = before;
  ChangeView(after, data_.camera, kMirror, kMirror);
  EXPECT_NEAR(after.keyframe_from_live.translation().x(),
              -before.keyframe_from_live.translation().x(), 1e-12);
  EXPECT_GT(cv::norm(before.live, after.live, cv::NORM_INF), 50);
  ChangeView(after, data_.camera, kMirror, kMirror);
  const auto kept = [&](const cv::Mat& image) {  // what lies outside of one mirror's image is lost
    const int lost = static_cast<int>(std::lround(image.cols - 1 - 2 * data_.camera.cx));
    return image.colRange(std::max(0, -lost), image.cols + std::min(0, -lost));
  };
  ASSERT_NE(data_.camera.cx, (before.live.cols - 1) / 2.0);
  EXPECT_EQ(cv::norm(kept(before.live), kept(after.live), cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(kept(before.key), kept(after.key), cv::NORM_INF), 0);
  const SE3 moved = before.keyframe_from_live.Inverse() * after.keyframe_from_live;
  EXPECT_LT(moved.Log().norm(), 1e-12);
  cv::Mat both, apart;
  cv::bitwise_and(before.live_depth > 0, after.live_depth > 0, both);
  cv::bitwise_and(cv::abs(before.live_depth - after.live_depth) > 0.03 * before.live_depth, both,
                  apart);
  EXPECT_GT(cv::countNonZero(both), 2000);
  EXPECT_LT(cv::countNonZero(apart), 0.03 * cv::countNonZero(both));
}

TEST_F(PairViewTest, HalfOfThePairsAreMirrored) {
  Random random(1);
  int mirrored = 0;
  for (int i = 0; i < 60; ++i) {
    PairView pair = ViewOf(data_, Nth(1));
    const Eigen::Vector3d before = pair.keyframe_from_live.translation();
    AugmentView(pair, data_.camera, {.mirror = true}, random);
    const Eigen::Vector3d after = pair.keyframe_from_live.translation();
    ASSERT_NEAR(std::abs(after.x()), std::abs(before.x()), 1e-12);
    mirrored += std::signbit(after.x()) != std::signbit(before.x());
  }
  EXPECT_GT(mirrored, 15);
  EXPECT_LT(mirrored, 45);
}

TEST_F(PairViewTest, TurnsAreWithinTheirBound) {
  constexpr double kBound = 0.05;
  Random random(1);
  double most = 0;
  for (int i = 0; i < 60; ++i) {
    PairView pair = ViewOf(data_, Nth(2));
    const Eigen::Matrix3d before = pair.keyframe_from_live.rotation();
    AugmentView(pair, data_.camera, {.turn_rad = kBound}, random);
    // Both are turned, each by up to the diagonal of a cube.
    const double angle = LogSo3(before.transpose() * pair.keyframe_from_live.rotation()).norm();
    EXPECT_LT(angle, 2 * std::sqrt(3.0) * kBound);
    most = std::max(most, angle);
  }
  EXPECT_GT(most, kBound);
}

class LoaderViews : public PairViewTest {
 protected:
  Batch Third(const LoaderOptions& options) const {
    Loader loader(data_, options, 2);
    return loader.Next();
  }
  static bool Equal(const Batch& a, const Batch& b) {
    return torch::equal(a.live, b.live) && torch::equal(a.key, b.key) &&
           torch::equal(a.motion, b.motion) && torch::equal(a.depth, b.depth);
  }

  LoaderOptions options_{
      .batch = 4, .augment = true, .seed = 3, .view = {.turn_rad = 0.05, .mirror = true}};
};

TEST_F(LoaderViews, FollowFromSeedAndNumberWhateverTheThreads) {
  const Batch one = Third(options_);
  const int threads = cv::getNumThreads();
  cv::setNumThreads(threads > 1 ? 1 : 3);
  Loader from_the_start(data_, options_);
  from_the_start.Next();
  from_the_start.Next();
  EXPECT_TRUE(Equal(from_the_start.Next(), one));
  cv::setNumThreads(threads);

  LoaderOptions other = options_;
  other.seed = 4;
  EXPECT_FALSE(Equal(Third(other), one));
  other = options_;
  other.view = {};
  const Batch plain = Third(other);
  EXPECT_FALSE(torch::equal(plain.live, one.live));
  // Of the same pairs: no motion is made longer.
  EXPECT_TRUE(torch::allclose(plain.motion.select(2, 3).norm(2, 1),
                              one.motion.select(2, 3).norm(2, 1), 1e-5, 1e-5));
}

TEST_F(LoaderViews, AreSharedOutAmongRanks) {
  const Batch whole = Third(options_);
  for (int rank = 0; rank < 2; ++rank) {
    LoaderOptions part = options_;
    part.rank = rank;
    part.ranks = 2;
    const Batch batch = Third(part);
    EXPECT_TRUE(torch::equal(batch.live, whole.live.narrow(0, 2 * rank, 2)));
    EXPECT_TRUE(torch::equal(batch.motion, whole.motion.narrow(0, 2 * rank, 2)));
    EXPECT_TRUE(torch::equal(batch.depth, whole.depth.narrow(0, 2 * rank, 2)));
  }
}

}  // namespace
}  // namespace recollect::cnn
