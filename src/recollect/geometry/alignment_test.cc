#include "recollect/geometry/alignment.h"

#include <gtest/gtest.h>

#include "recollect/core/error.h"

namespace recollect {
namespace {

using Points = std::vector<Eigen::Vector3d>;

const Points kSource = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0.5, -1, 3}, {7e3, 2, 1}};
const Similarity kTruth{2.5, SE3::FromRotationVector({0.5, -2, 1}, {100, -7, 3})};

Points Moved(const Similarity& by) {
  Points moved;
  for (const Eigen::Vector3d& p : kSource) moved.push_back(by * p);
  return moved;
}

TEST(Alignment, FindsASimilarity) {
  const Similarity found = AlignPoints(kSource, Moved(kTruth), true);
  EXPECT_NEAR(found.scale, 2.5, 1e-11);
  EXPECT_LT((found.motion.rotation() - kTruth.motion.rotation()).norm(), 1e-10);
  EXPECT_LT((found.motion.translation() - kTruth.motion.translation()).norm(), 1e-7);
}

TEST(Alignment, FindsARigidMotion) {
  const Similarity truth{1, kTruth.motion};
  const Similarity found = AlignPoints(kSource, Moved(truth), false);
  EXPECT_EQ(found.scale, 1);
  EXPECT_LT((found.motion.Matrix() - truth.motion.Matrix()).norm(), 1e-8);
}

// The best orthogonal matrix for a mirror image is a reflection, which is no motion.
TEST(Alignment, TurnsRatherThanMirrors) {
  const Points x = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 1}, {0, 0, -1}};
  Points y;
  for (const Eigen::Vector3d& p : x) y.emplace_back(-p.x(), p.y(), p.z());
  const Similarity found = AlignPoints(x, y, true);
  EXPECT_TRUE(IsRotation(found.motion.rotation(), 1e-12));
}

// By hand: 4 corners of a square of side 2 about the origin against one of side 3 turned by 90
// degrees; the rigid motion leaves each corner (3 - 2) / sqrt(2) off.
TEST(Alignment, LeavesTheLeastSquares) {
  const Points x = {{1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {1, -1, 0}};
  const Points y = {{-1.5, 1.5, 5}, {-1.5, -1.5, 5}, {1.5, -1.5, 5}, {1.5, 1.5, 5}};
  const Similarity rigid = AlignPoints(x, y, false), similar = AlignPoints(x, y, true);
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_NEAR((rigid * x[i] - y[i]).norm(), std::sqrt(0.5), 1e-12);
    EXPECT_NEAR((similar * x[i] - y[i]).norm(), 0, 1e-12);
  }
  EXPECT_NEAR(similar.scale, 1.5, 1e-12);
}

TEST(Alignment, MovesPosesWithoutScalingTheirRotation) {
  const SE3 moved = kTruth * SE3::FromRotationVector({0.1, 0.2, 0.3}, {1, 2, 3});
  EXPECT_TRUE(IsRotation(moved.rotation(), 1e-12));
  EXPECT_LT((moved.translation() - kTruth * Eigen::Vector3d(1, 2, 3)).norm(), 1e-12);
  const std::vector<SE3> poses = {SE3(), moved, SE3(moved.rotation(), {5, 5, 5})};
  EXPECT_LT((AlignPoses(poses, poses, true).motion.Matrix() - Eigen::Matrix4d::Identity()).norm(),
            1e-10);
}

TEST(Alignment, RefusesWhatLeavesTheRotationOpen) {
  EXPECT_THROW(AlignPoints({{0, 0, 0}, {1, 0, 0}}, {{0, 0, 0}, {1, 0, 0}}, false), Error);
  EXPECT_THROW(AlignPoints(kSource, {{0, 0, 0}}, false), Error);
  const Points line = {{0, 0, 0}, {1, 1, 1}, {3, 3, 3}}, point(3, {1, 2, 3});
  EXPECT_THROW(AlignPoints(line, line, true), Error);
  EXPECT_THROW(AlignPoints(point, point, true), Error);
}

}  // namespace
}  // namespace recollect
