#include "recollect/wnn/certificate.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace recollect::wnn {
namespace {

constexpr int kMaxLabels = 16;        // candidates
constexpr int kMaxEntries = 64;       // of all candidates together
constexpr std::size_t kMinStep = 16;  // neurons asked before the matter is looked at again
constexpr int kGrain = 16;            // neurons that a thread takes at a time

// What each label can still gain.
class Open {
 public:
  Open(const Memory& memory, const Candidates& candidates,
       const std::vector<std::vector<int>>& neurons, int unread)
      : any_(unread),
        candidate_(static_cast<std::size_t>(memory.neurons()), -1),
        gain_(static_cast<std::size_t>(memory.labels()), -1) {
    for (std::size_t c = 0; c < candidates.labels.size(); ++c) {
      const int label = candidates.labels[c];
      gain_[static_cast<std::size_t>(label)] = static_cast<int>(neurons[c].size());
      for (const int n : neurons[c]) candidate_[static_cast<std::size_t>(n)] = label;
    }
  }

  // The candidate that the neuron may vote for; -1: there are no candidates.
  int Candidate(int neuron) const { return candidate_[static_cast<std::size_t>(neuron)]; }

  void Close(int neuron) {
    --any_;
    if (Candidate(neuron) >= 0) --gain_[static_cast<std::size_t>(Candidate(neuron))];
  }

  // How many votes the leader lacks to be sure of winning; none or fewer: it wins.
  int Lacking(const Tally& tally) const {
    int lacking = -tally.votes(tally.leader());
    for (int label = 0; label < static_cast<int>(gain_.size()); ++label) {
      if (label == tally.leader()) continue;
      const int gain = gain_[static_cast<std::size_t>(label)];
      const int most = tally.votes(label) + (gain >= 0 ? gain : any_);
      const int tie = label < tally.leader() ? 1 : 0;  // which the lower label would win
      lacking = std::max(lacking, most + tie - tally.votes(tally.leader()));
    }
    return lacking;
  }

 private:
  int any_;                     // neurons not yet asked
  std::vector<int> candidate_;  // by neuron
  std::vector<int> gain_;       // by label; -1: no candidate
};

}  // namespace

Verdict AskUntilCertain(const Memory& memory, Asking& asking, Tally& tally,
                        const EntrySet* allowed) {
  const int neurons = memory.neurons(), first = tally.read();
  const Candidates candidates = ChooseCandidates(memory, tally, allowed, kMaxLabels, kMaxEntries);
  Open open(memory, candidates, Peek(memory, asking, tally, candidates), neurons - first);

  std::vector<int> fair_votes;  // of the candidates, among the neurons asked in random order
  for (const int label : candidates.labels) fair_votes.push_back(tally.votes(label));

  std::vector<int> order(static_cast<std::size_t>(neurons - first));
  std::iota(order.begin(), order.end(), first);
  const auto rank = [&, leader = tally.leader()](int n) {
    return (open.Candidate(n) == leader ? 0 : 256) + AnswerDistance(asking.answer(n));
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return rank(a) < rank(b); });

  std::size_t asked = 0;
  for (;;) {
    const int lacking = open.Lacking(tally);
    if (asked == order.size() || lacking <= 0) break;
    // A neuron changes the matter by two at most, so none of these is asked in vain.
    const std::size_t step = std::max(kMinStep, static_cast<std::size_t>(lacking) / 2);
    const std::size_t end = std::min(order.size(), asked + step);
    const std::span<int> portion(order.data() + asked, end - asked);
    std::sort(portion.begin(), portion.end());  // neighbours in memory together
    asking.Ask(portion, kGrain);
    for (const int n : portion) {
      open.Close(n);
      tally.Add(memory.label(asking.entry(n)));
    }
    asked = end;
  }
  for (; asked < order.size(); ++asked) asking.Forget(order[asked]);

  const int winner = tally.leader();
  const double scale = static_cast<double>(neurons) / first;
  double votes = tally.votes(winner), second = 0;
  for (std::size_t c = 0; c < candidates.labels.size(); ++c) {
    const int label = candidates.labels[c];
    const double estimate = scale * fair_votes[c];
    if (label == winner) {
      votes = std::max(votes, estimate);
    } else {
      second = std::max(second, estimate);
    }
  }
  return {winner, std::max(0.0, votes - second) / votes};
}

}  // namespace recollect::wnn
