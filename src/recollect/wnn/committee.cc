#include "recollect/wnn/committee.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "recollect/core/error.h"

namespace recollect::wnn {

Recollection CountVotes(std::span<const int> labels, std::vector<Answer> answers) {
  Recollection result;
  std::vector<int> votes;  // the labels of all who answered
  votes.reserve(answers.size());
  for (const Answer answer : answers) {
    if (answer != kNoAnswer) {
      votes.push_back(labels[static_cast<std::size_t>(AnswerEntry(answer))]);
    }
  }
  result.neurons_read = static_cast<int>(votes.size());
  std::sort(votes.begin(), votes.end());
  for (const int label : votes) {
    if (result.histogram.empty() || result.histogram.back().label != label) {
      result.histogram.push_back({label, 0});
    }
    ++result.histogram.back().votes;
  }
  std::stable_sort(result.histogram.begin(), result.histogram.end(),
                   [](const LabelVotes& a, const LabelVotes& b) { return a.votes > b.votes; });
  if (!result.histogram.empty()) {
    const int first = result.histogram[0].votes;
    const int second = result.histogram.size() > 1 ? result.histogram[1].votes : 0;
    result.winner = result.histogram[0].label;
    result.confidence = static_cast<double>(first - second) / first;
  }
  result.answers = std::move(answers);
  return result;
}

std::vector<double> SharesWithin(std::span<const int> answers, std::span<const int> truths,
                                 std::span<const int> within) {
  Require(answers.size() == truths.size() && !answers.empty(), "accuracy",
          "as many answers as truths are needed, and at least one");
  std::vector<double> shares;
  for (const int limit : within) {
    int hits = 0;
    for (std::size_t i = 0; i < answers.size(); ++i)
      hits += std::abs(answers[i] - truths[i]) <= limit;
    shares.push_back(static_cast<double>(hits) / static_cast<double>(answers.size()));
  }
  return shares;
}

}  // namespace recollect::wnn
