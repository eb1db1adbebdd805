#include "recollect/wnn/tally.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace recollect::wnn {
namespace {

// Votes counted before anyone is nominated: the first leaders change with every vote. Nominations
// are repeated when so many times as many votes are in; each time takes half of what stakes are
// left.
constexpr int kPilot = 32;
constexpr int kNextRound = 4;
constexpr std::size_t kNominees = 4;

}  // namespace

// The stake is spread evenly over all p in (1/2, 1]; one bet on "a's share is p" multiplies its
// part by 2p for a vote for a and by 2 (1 - p) for one for b. So the score is
//   2^(n+1) * integral over (1/2, 1] of p^a (1-p)^b dp,  n = a + b,
// and the integral is B(a+1, b+1) times the chance of at most a heads in n + 1 fair tosses.
double LogEvidence(int a, int b) {
  const int n = a + b;
  // Heads at most a among n + 1, from the smaller tail by its terms' ratio.
  const int rare = std::min(a, n - a);  // the tail summed: at most `rare` heads
  double sum = 1, term = 1;
  for (int k = rare; k > 0 && term > 1e-17 * sum; --k) {
    term *= static_cast<double>(k) / (n + 2 - k);
    sum += term;
  }
  const double log_choose =
      std::lgamma(n + 2.0) - std::lgamma(rare + 1.0) - std::lgamma(n + 2.0 - rare);
  const double log_tail = log_choose + std::log(sum) - (n + 1) * std::numbers::ln2;
  // At most a heads: that tail itself, or all but the tail of at most n - a = b heads.
  const double log_heads = rare == a ? log_tail : std::log1p(-std::exp(log_tail));
  return (n + 1) * std::numbers::ln2 + std::lgamma(a + 1.0) + std::lgamma(b + 1.0) -
         std::lgamma(n + 2.0) + log_heads;
}

Tally::Tally(int labels, int neurons, double error_bound)
    : neurons_(neurons),
      log_bound_(std::log(error_bound)),
      votes_(static_cast<std::size_t>(labels), 0) {}

void Tally::Nominate() {
  std::vector<int> best = voted_;
  const auto kept = std::min(kNominees, best.size());
  std::partial_sort(
      best.begin(), best.begin() + static_cast<std::ptrdiff_t>(kept), best.end(),
      [&](int a, int b) { return votes(a) > votes(b) || (votes(a) == votes(b) && a < b); });
  votes_at_.push_back(votes_);
  const double stake = std::pow(0.5, static_cast<double>(votes_at_.size()));
  for (std::size_t i = 0; i < kept; ++i) {
    // Half for the leader, the other half for the rest.
    const double share = i == 0 ? 0.5 : 0.5 / static_cast<double>(kNominees - 1);
    Nominee nominee{best[i], std::log(stake * share), votes_at_.size() - 1, {best[i]}};
    for (const int label : best) {
      if (votes(label) > votes(best[i])) nominee.overtakers.push_back(label);
    }
    nominees_.push_back(std::move(nominee));
  }
}

void Tally::Add(int label) {
  const auto i = static_cast<std::size_t>(label);
  ++read_;
  if (votes_[i]++ == 0) voted_.push_back(label);
  const bool ahead =
      leader_ < 0 || votes_[i] > votes(leader_) || (votes_[i] == votes(leader_) && label < leader_);
  if (label != leader_ && ahead) {
    second_ = leader_ < 0 ? 0 : votes(leader_);
    leader_ = label;
  } else if (label != leader_) {
    second_ = std::max(second_, votes_[i]);
  }
  for (Nominee& nominee : nominees_) {
    auto& overtakers = nominee.overtakers;
    if (votes_[i] == votes(nominee.label) + 1 &&
        std::find(overtakers.begin(), overtakers.end(), label) == overtakers.end()) {
      overtakers.push_back(label);
    }
  }
  if (read_ == kPilot || (!votes_at_.empty() && read_ == next_round_)) {
    Nominate();
    next_round_ = read_ * kNextRound;
  }
}

bool Tally::Certain() const { return leader_ >= 0 && votes(leader_) - second_ > neurons_ - read_; }

bool Tally::Lost(std::span<const int> most, int rival) const {
  double evidence = 0;
  for (const Nominee& nominee : nominees_) {
    const auto& overtakers = nominee.overtakers;
    if (std::find(overtakers.begin(), overtakers.end(), rival) != overtakers.end()) continue;
    const auto& before = votes_at_[nominee.round];
    const int for_nominee = votes(nominee.label) - before[static_cast<std::size_t>(nominee.label)];
    const double score = LogEvidence(for_nominee, most[nominee.round]) + nominee.log_stake;
    evidence += std::exp(std::min(700.0, score + log_bound_));
    if (evidence >= 1) return true;
  }
  return false;
}

bool Tally::Confident() const { return Certain() || ConfidentBut({}); }

bool Tally::ConfidentBut(std::span<const int> rivals) const {
  std::vector<int> apart;  // labels that some nominee may not bet against
  for (const Nominee& nominee : nominees_) {
    apart.insert(apart.end(), nominee.overtakers.begin(), nominee.overtakers.end());
  }
  std::sort(apart.begin(), apart.end());
  apart.erase(std::unique(apart.begin(), apart.end()), apart.end());
  std::vector<int> most(votes_at_.size(), 0), own(votes_at_.size());
  const auto since = [&](int label, std::size_t round) {
    return votes(label) - votes_at_[round][static_cast<std::size_t>(label)];
  };
  const auto spared = [&](int label) {
    return label == leader_ || std::find(rivals.begin(), rivals.end(), label) != rivals.end();
  };
  for (const int label : voted_) {
    if (spared(label)) continue;
    const bool alone = std::binary_search(apart.begin(), apart.end(), label);
    for (std::size_t round = 0; round < most.size(); ++round) {
      own[round] = since(label, round);
      if (!alone) most[round] = std::max(most[round], own[round]);
    }
    if (alone && !Lost(own, label)) return false;
  }
  return Lost(most, -1);
}

}  // namespace recollect::wnn
