#include "recollect/geometry/trajectory_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "recollect/core/error.h"

namespace recollect {
namespace {

constexpr double kTolerance = 1e-9;

SE3 Pose(double x, double y, double yaw) { return SE3::FromRotationVector({0, 0, yaw}, {x, y, 0}); }

// Along x, one metre a step.
const std::vector<SE3> kReference = {Pose(0, 0, 0), Pose(1, 0, 0), Pose(2, 0, 0), Pose(3, 0, 0)};
// Off by (0, 0), (0, 1), (0, 2), (3, 4), and by yaws of 0, 0.1, 0.2, -0.5.
const std::vector<SE3> kEstimate = {Pose(0, 0, 0), Pose(1, 1, 0.1), Pose(2, 2, 0.2),
                                    Pose(6, 4, -0.5)};

void ExpectNear(const std::vector<double>& actual, const std::vector<double>& expected) {
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t i = 0; i < actual.size(); ++i) EXPECT_NEAR(actual[i], expected[i], kTolerance);
}

TEST(AbsoluteErrors, AreThoseComputedByHand) {
  ExpectNear(AbsoluteErrors(kReference, kEstimate, PoseRelation::kTranslationPart), {0, 1, 2, 5});
  ExpectNear(AbsoluteErrors(kReference, kEstimate, PoseRelation::kRotationAngle),
             {0, 0.1, 0.2, 0.5});
  // |R - I| of a turn by a: sqrt(2 (2 - 2 cos a)) = 2 sqrt(2) sin(a / 2).
  const auto frobenius = [](double a) { return 2 * std::sqrt(2) * std::sin(a / 2); };
  ExpectNear(AbsoluteErrors(kReference, kEstimate, PoseRelation::kRotationPart),
             {0, frobenius(0.1), frobenius(0.2), frobenius(0.5)});
  ExpectNear(AbsoluteErrors(kReference, kEstimate, PoseRelation::kFullTransformation),
             {0, std::hypot(1, frobenius(0.1)), std::hypot(2, frobenius(0.2)),
              std::hypot(5, frobenius(0.5))});
}

TEST(ErrorStatistics, AreThoseComputedByHand) {
  const ErrorStatistics s = StatisticsOf({2, 0, 5, 1});
  EXPECT_NEAR(s.sse, 30, kTolerance);
  EXPECT_NEAR(s.rmse, std::sqrt(7.5), kTolerance);
  EXPECT_NEAR(s.mean, 2, kTolerance);
  EXPECT_NEAR(s.median, 1.5, kTolerance);
  EXPECT_NEAR(s.std, std::sqrt(3.5), kTolerance);  // of 4, 4, 9 and 1 squared deviations: 14 / 4
  EXPECT_EQ(s.min, 0);
  EXPECT_EQ(s.max, 5);
  EXPECT_EQ(StatisticsOf({3, 1, 2}).median, 2);
}

// Steps of the estimate in its own frame: (1, 1), R(-0.1)(1, 1), R(-0.2)(4, 2); those of the
// reference are (1, 0).
TEST(RelativeErrors, ByFramesAreThoseComputedByHand) {
  const double c1 = std::cos(0.1), s1 = std::sin(0.1), c2 = std::cos(0.2), s2 = std::sin(0.2);
  const std::vector<double> steps = {1, std::hypot(c1 + s1 - 1, c1 - s1),
                                     std::hypot(4 * c2 + 2 * s2 - 1, 2 * c2 - 4 * s2)};
  ExpectNear(RelativeErrors(kReference, kEstimate), steps);
  RelativeErrorOptions options;
  options.relation = PoseRelation::kRotationAngle;
  ExpectNear(RelativeErrors(kReference, kEstimate, options), {0.1, 0.1, 0.7});
  // Pairs two frames apart: (0, 2) alone, and (1, 3) too when all are taken.
  options.delta = 2;
  ExpectNear(RelativeErrors(kReference, kEstimate, options), {0.2});
  options.all_pairs = true;
  ExpectNear(RelativeErrors(kReference, kEstimate, options), {0.2, 0.6});
}

// Path lengths of the estimate: 0, sqrt(2), 2 sqrt(2), 2 sqrt(2) + sqrt(20); of the reference:
// 0, 1, 2, 3.
TEST(RelativeErrors, ByMetresTakeTheirPairsFromThePath) {
  RelativeErrorOptions options;
  options.relation = PoseRelation::kRotationAngle;
  options.unit = DeltaUnit::kMetres;
  options.delta = 1.4;  // stretches end at poses 1, 2 and 3
  ExpectNear(RelativeErrors(kReference, kEstimate, options), {0.1, 0.7});
  options.all_pairs = true;  // from 2 to 3 it is 4.47 m, far off 1.4
  ExpectNear(RelativeErrors(kReference, kEstimate, options), {0.1, 0.1});
  options.tolerance = 3;
  ExpectNear(RelativeErrors(kReference, kEstimate, options), {0.1, 0.1, 0.7});
  options.pairs_from_reference = true;
  options.delta = 2;
  options.tolerance = 0;
  ExpectNear(RelativeErrors(kReference, kEstimate, options), {0.2, 0.6});
}

TEST(TrajectoryErrors, AreZeroForAPerfectEstimate) {
  EXPECT_EQ(StatisticsOf(RelativeErrors(kReference, kReference)).max, 0);
  EXPECT_EQ(StatisticsOf(AbsoluteErrors(kEstimate, kEstimate, PoseRelation::kTranslationPart)).max,
            0);
}

TEST(TrajectoryErrors, RefuseWhatCannotBeCompared) {
  EXPECT_THROW(AbsoluteErrors({}, {}, PoseRelation::kRotationAngle), Error);
  EXPECT_THROW(AbsoluteErrors(kReference, {SE3()}, PoseRelation::kRotationAngle), Error);
  EXPECT_THROW(StatisticsOf({}), Error);
  RelativeErrorOptions options;
  for (const double delta : {0.0, -1.0, 0.5, 4.0}) {
    options.delta = delta;
    EXPECT_THROW(RelativeErrors(kReference, kEstimate, options), Error) << delta;
  }
  options.unit = DeltaUnit::kMetres;
  options.delta = 1000;
  EXPECT_THROW(RelativeErrors(kReference, kEstimate, options), Error);
}

}  // namespace
}  // namespace recollect
