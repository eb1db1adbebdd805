#include "recollect/evaluation/place_trials.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "recollect/core/parallel.h"
#include "recollect/testing/scratch_folder.h"
#include "recollect/testing/street.h"

namespace recollect {
namespace {

// A street mapped once, every five metres.
class PlaceTrialsTest : public ::testing::Test {
 protected:
  testing::ScratchFolder folder_;
  ThreadPool pool_{2};
  PlaceImages places_ =
      ReadPlaces({testing::DriveStreet(folder_ / "a", {.length_m = 60, .seed = 1})}, 5);
  LearntPlaces learnt_{places_, wnn::RecollectNetwork(), pool_};
};

bool VotesForItself(const wnn::Trial& trial) {
  return std::any_of(trial.histogram.begin(), trial.histogram.end(),
                     [&](const wnn::LabelVotes& one) { return one.label == trial.place; });
}

TEST_F(PlaceTrialsTest, AChangedCopyMayFindItsOwnImageUnlessLeftOut) {
  int found = 0;
  const auto trials = learnt_.Trials(pool_, {.nowhere = false});
  ASSERT_EQ(trials.size(), places_.images.size());
  for (const wnn::Trial& trial : trials) {
    EXPECT_TRUE(trial.copy);
    found += VotesForItself(trial);
  }
  EXPECT_GE(found, static_cast<int>(trials.size()) - 1);
  for (const wnn::Trial& trial : learnt_.Trials(pool_, {.nowhere = false, .leave_out = true})) {
    EXPECT_FALSE(VotesForItself(trial));
  }
}

TEST_F(PlaceTrialsTest, AnswersTellHowSureTheyAreAndWhetherTheyAreRight) {
  const Lap live =
      testing::DriveStreet(folder_ / "b", {.length_m = 50, .lateral_m = 0.3, .seed = 2});
  const wnn::Calibration calibration = wnn::Calibrate(places_.route, learnt_.Trials(pool_));
  const auto answers = AnswerLive(learnt_, live, 2, {.history = 0, .votes = calibration.sequence},
                                  calibration, pool_);
  ASSERT_GE(answers.size(), 20u);
  int right = 0;
  for (const PlaceAnswer& answer : answers) {
    for (const Told& told : {answer.single, answer.filtered}) {
      EXPECT_GE(told.probability, 0);
      EXPECT_LE(told.probability, 1);
    }
    // The nearest key frame is at most two and a half metres away, one next to it five more.
    EXPECT_TRUE(answer.single.right ? answer.supported_m < 8 : answer.supported_m > 7);
    EXPECT_TRUE(answer.filtered.right ? answer.filtered_m < 8 : answer.filtered_m > 7);
    right += answer.filtered.right;
  }
  EXPECT_GE(right, static_cast<int>(answers.size()) - 2);
}

}  // namespace
}  // namespace recollect
