#include "recollect/wnn/committee.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "recollect/core/error.h"

namespace recollect::wnn {

Recollection CountVotes(std::span<const int> labels, std::vector<Answer> answers) {
  Recollection result;
  std::vector<int> votes;  // by label
  for (const Answer answer : answers) {
    if (answer == kNoAnswer) continue;
    ++result.neurons_read;
    const auto label =
        static_cast<std::size_t>(labels[static_cast<std::size_t>(AnswerEntry(answer))]);
    if (label >= votes.size()) votes.resize(std::max(label + 1, 2 * votes.size()), 0);
    ++votes[label];
  }
  for (std::size_t label = 0; label < votes.size(); ++label) {
    if (votes[label] > 0) result.histogram.push_back({static_cast<int>(label), votes[label]});
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
