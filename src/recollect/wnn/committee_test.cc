#include "recollect/wnn/committee.h"

#include <gtest/gtest.h>

#include "recollect/core/error.h"

namespace recollect::wnn {
namespace {

std::vector<Answer> Answers(std::initializer_list<int> entries) {
  std::vector<Answer> answers;
  for (const int entry : entries) {
    answers.push_back(entry < 0 ? kNoAnswer : MakeAnswer(entry, 0, entry));
  }
  return answers;
}

TEST(Committee, CountsVotesByLabel) {
  const Recollection r = CountVotes(std::vector<int>({5, 3, 5, 0}), Answers({0, 1, 2, 1, 2, 3}));
  EXPECT_EQ(r.winner, 5);
  EXPECT_EQ(r.neurons_read, 6);
  EXPECT_DOUBLE_EQ(r.confidence, 1.0 / 3);
  ASSERT_EQ(r.histogram.size(), 3u);
  EXPECT_EQ(r.histogram[0].votes, 3);
  EXPECT_EQ(r.histogram[1].label, 3);
  EXPECT_EQ(r.histogram[1].votes, 2);
  EXPECT_EQ(r.histogram[2].label, 0);
}

TEST(Committee, OfEqualLabelsTheLowestWinsWithoutConfidence) {
  const Recollection r = CountVotes(std::vector<int>({9, 3, 7, 0}), Answers({0, 0, 2, 2, 1, 1}));
  EXPECT_EQ(r.winner, 3);
  EXPECT_DOUBLE_EQ(r.confidence, 0);
  EXPECT_EQ(r.histogram[1].label, 7);
}

TEST(Committee, LeavesOutNeuronsThatWereNotAsked) {
  const Recollection r =
      CountVotes(std::vector<int>({0, 1, 2, 3}), Answers({-1, 2, -1, -1, 2, -1}));
  EXPECT_EQ(r.neurons_read, 2);
  EXPECT_EQ(r.winner, 2);
  EXPECT_DOUBLE_EQ(r.confidence, 1);
  const Recollection none = CountVotes({}, {kNoAnswer});
  EXPECT_EQ(none.winner, -1);
  EXPECT_EQ(none.confidence, 0);
}

TEST(Committee, SharesWithinCountFrames) {
  const std::vector<int> answers = {5, 7, 9, 0}, truths = {5, 8, 6, 9}, within = {0, 1, 3, 10};
  EXPECT_EQ(SharesWithin(answers, truths, within), (std::vector<double>{0.25, 0.5, 0.75, 1.0}));
  EXPECT_THROW(SharesWithin({}, {}, within), Error);
  EXPECT_THROW(SharesWithin(answers, std::vector<int>{1}, within), Error);
}

}  // namespace
}  // namespace recollect::wnn
