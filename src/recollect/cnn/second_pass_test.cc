#include "recollect/cnn/second_pass.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "recollect/cnn/test_street.h"

namespace recollect::cnn {
namespace {

// The untrained network answers with the key frame's own pose.
class SecondPass : public ::testing::Test {
 protected:
  SecondPass()
      : data_(LoadPairs(std::span(street_.laps()).last(1), std::span(street_.laps()).first(1),
                        network_.crop(), {}, pool_)) {}

  // Headings' errors of one live frame from two key frames at one place, the second of which looks
  // so many radians to the side.
  std::vector<double> WhereOneLooksAside(double radians) {
    const Pair first = data_.pairs.front();
    const auto second = std::find_if(data_.pairs.begin(), data_.pairs.end(), [&](const Pair& pair) {
      return pair.live == first.live && pair.key > first.key;
    });
    PairData two = data_;
    two.frames[second->key].world_from_camera = data_.frames[first.key].world_from_camera *
                                                SE3::FromRotationVector({0, radians, 0}, {0, 0, 0});
    two.pairs = {first, *second};
    return EvaluateSecondPass(network_, two).heading_deg;
  }

  const TestStreet street_{{{.length_m = 10}, {.length_m = 10, .lateral_m = 0.5, .seed = 2}}};
  ThreadPool pool_{1};
  const PoseNetwork network_ = PoseNetwork::Untrained(320, 240);
  const PairData data_;
};

TEST_F(SecondPass, ChangesNothingWhereTheFirstAnswerLeadsBack) {
  const PairFigures once = EvaluatePairs(network_, data_, {}).Figures();
  const PairFigures twice = EvaluateSecondPass(network_, data_).Figures();
  EXPECT_EQ(twice.pairs, once.pairs);
  EXPECT_NEAR(twice.position_mean_m, once.position_mean_m, 1e-6);
  EXPECT_NEAR(twice.heading_mean_deg, once.heading_mean_deg, 1e-6);
  EXPECT_NEAR(twice.no_motion_mean_m, once.no_motion_mean_m, 1e-9);
}

TEST_F(SecondPass, AnswersWithTheKeyFrameThatTheFirstAnswerLeadsTo) {
  const std::vector<double> alike = WhereOneLooksAside(0.3), away = WhereOneLooksAside(2);
  ASSERT_EQ(alike.size(), 2U);
  EXPECT_NEAR(alike[1], alike[0], 1e-6);  // both lead to the first
  EXPECT_GT(away[1], away[0] + 90);       // which is not alike to one that looks away
}

}  // namespace
}  // namespace recollect::cnn
