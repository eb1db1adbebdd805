// Values of a script that shares nothing with the library: trajectory_error_check.py prints them.
#include <gtest/gtest.h>

#include <cmath>

#include "recollect/geometry/alignment.h"
#include "recollect/geometry/trajectory_error.h"

namespace recollect {
namespace {

constexpr int kPoses = 60;
constexpr double kTolerance = 1e-9;

SE3 Reference(double i) {
  return SE3::FromRotationVector(
      {0.02 * std::sin(0.2 * i), 0.01 * i, 0.05 * std::cos(0.1 * i)},
      {30 * std::cos(0.05 * i), 20 * std::sin(0.05 * i), 0.5 * std::sin(0.3 * i)});
}

SE3 Estimate(double i) {
  const SE3 truth = Reference(i);
  const Eigen::Vector3d noise(0.01 * std::sin(1.3 * i), 0.02 * std::cos(0.7 * i),
                              0.015 * std::sin(2.1 * i));
  const Eigen::Vector3d off(0.4 * std::sin(0.9 * i), 0.3 * std::cos(1.7 * i),
                            0.2 * std::sin(0.4 * i) + 0.004 * i);
  return {truth.rotation() * ExpSo3(noise), truth.translation() + off};
}

class TrajectoryErrorCheck : public ::testing::Test {
 protected:
  TrajectoryErrorCheck() {
    for (int i = 0; i < kPoses; ++i) {
      reference_.push_back(Reference(i));
      estimate_.push_back(Estimate(i));
    }
  }

  // expected: rmse, mean, median, std, min, max, sse.
  static void Expect(const std::vector<double>& errors, const std::vector<double>& expected) {
    const ErrorStatistics s = StatisticsOf(errors);
    const double actual[] = {s.rmse, s.mean, s.median, s.std, s.min, s.max, s.sse};
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_NEAR(actual[i], expected[i], kTolerance) << i;
    }
  }
  std::vector<double> Relative(const RelativeErrorOptions& options) const {
    return RelativeErrors(reference_, estimate_, options);
  }

  std::vector<SE3> reference_, estimate_;
};

TEST_F(TrajectoryErrorCheck, Absolute) {
  using enum PoseRelation;
  Expect(AbsoluteErrors(reference_, estimate_, kTranslationPart),
         {0.40308236970907674, 0.3895881744039925, 0.40098046750364125, 0.10342364881809711,
          0.10060373651349945, 0.5911260732085524, 9.748523806217088});
  Expect(AbsoluteErrors(reference_, estimate_, kRotationPart),
         {0.027083449855164605, 0.026300499442205003, 0.028294158630737906, 0.006465058789198295,
          0.013676729190902969, 0.03558109495659916, 0.04401079536343294});
  Expect(AbsoluteErrors(reference_, estimate_, kRotationAngle),
         {0.019151242823978874, 0.018597576947693872, 0.020007325133951315, 0.004571677304623298,
          0.009670945642644056, 0.025160297165954137, 0.022006206102180133});
  Expect(AbsoluteErrors(reference_, estimate_, kFullTransformation),
         {0.40399122518483244, 0.3906432825311242, 0.4014166167800439, 0.10298900834385341,
          0.1060818058744318, 0.5921519249930225, 9.79253460158052});
}

TEST_F(TrajectoryErrorCheck, RelativeByFrames) {
  using enum PoseRelation;
  const auto one = Relative({});
  ASSERT_EQ(one.size(), 59u);
  Expect(one, {0.40754153722503617, 0.3894327286964134, 0.4060972559414998, 0.1201343180935875,
               0.08446850112755137, 0.5746765589340211, 9.799316169260987});
  const auto seven = Relative({.relation = kFullTransformation, .delta = 7});
  ASSERT_EQ(seven.size(), 8u);
  Expect(seven, {0.3689888906943835, 0.33585140642756767, 0.2912667223647374, 0.1528287743080356,
                 0.09686351780021667, 0.5927064262898676, 1.0892224116469738});
  const auto all = Relative({.relation = kRotationAngle, .delta = 7, .all_pairs = true});
  ASSERT_EQ(all.size(), 53u);
  Expect(all, {0.029350109956286972, 0.0286069526495496, 0.028719013990611948, 0.006562866336636986,
               0.013206009651249549, 0.03953821424819122, 0.045655734585645195});
}

TEST_F(TrajectoryErrorCheck, RelativeByMetres) {
  using enum DeltaUnit;
  const auto five = Relative({.delta = 5, .unit = kMetres});
  ASSERT_EQ(five.size(), 13u);
  Expect(five, {0.6268336272990007, 0.5923141965724831, 0.5596323187927869, 0.2051445559880067,
                0.22075219367056267, 0.8464404822547485, 5.1079651520666935});
  const auto all = Relative({.delta = 5, .unit = kMetres, .all_pairs = true});
  ASSERT_EQ(all.size(), 43u);
  Expect(all, {0.6330718894862473, 0.6040324944740852, 0.6436804260166917, 0.18953828868358355,
               0.19572377827476733, 0.8596623856843786, 17.233540742080553});
  const auto of_reference = Relative({.relation = PoseRelation::kRotationPart,
                                      .delta = 5,
                                      .unit = kMetres,
                                      .all_pairs = true,
                                      .pairs_from_reference = true});
  ASSERT_EQ(of_reference.size(), 32u);
  Expect(of_reference,
         {0.04783261633693091, 0.04613403453173227, 0.04450918641798023, 0.01263368685146836,
          0.026131276655399896, 0.06349568095141893, 0.07321469394035295});
}

// evo's --align and --align --correct_scale.
TEST_F(TrajectoryErrorCheck, AbsoluteOnceAligned) {
  const auto rmse = [&](const Similarity& alignment) {
    std::vector<SE3> aligned;
    for (const SE3& pose : estimate_) aligned.push_back(alignment * pose);
    return StatisticsOf(AbsoluteErrors(reference_, aligned, PoseRelation::kTranslationPart)).rmse;
  };
  EXPECT_NEAR(rmse(AlignPoses(estimate_, reference_, false)), 0.3792051836767892, kTolerance);
  const Similarity similarity = AlignPoses(estimate_, reference_, true);
  EXPECT_NEAR(similarity.scale, 0.9999181531903671, kTolerance);
  EXPECT_NEAR(rmse(similarity), 0.3792011244420468, kTolerance);
}

}  // namespace
}  // namespace recollect
