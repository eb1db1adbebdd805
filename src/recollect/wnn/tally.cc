#include "recollect/wnn/tally.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace recollect::wnn {
namespace {

// Votes counted before anyone is nominated: the first leaders change with every vote.
constexpr int kPilot = 32;

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
      error_bound_(error_bound),
      votes_(static_cast<std::size_t>(labels), 0),
      term_of_(static_cast<std::size_t>(labels), 0),
      votes_in_term_(static_cast<std::size_t>(labels), 0) {}

void Tally::Nominate() {
  ++terms_;
  for_leader_ = for_rival_ = 0;
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
    if (read_ > kPilot) return Nominate();
  } else if (label != leader_) {
    second_ = std::max(second_, votes_[i]);
  }
  if (read_ == kPilot) Nominate();
  if (read_ <= kPilot) return;

  if (term_of_[i] != terms_) {
    term_of_[i] = terms_;
    votes_in_term_[i] = 0;
  }
  const int in_term = ++votes_in_term_[i];
  if (label == leader_) {
    for_leader_ = in_term;
  } else {
    for_rival_ = std::max(for_rival_, in_term);
  }
}

bool Tally::Certain() const { return leader_ >= 0 && votes(leader_) - second_ > neurons_ - read_; }

bool Tally::Enough(int for_rival) const {
  if (terms_ == 0 || for_leader_ <= for_rival) return false;
  // Term t may err with a chance of error_bound / (t (t + 1)); these sum to error_bound.
  const double stake = static_cast<double>(terms_) * (terms_ + 1.0) / error_bound_;
  return LogEvidence(for_leader_, for_rival) >= std::log(stake);
}

bool Tally::Confident() const { return Certain() || Enough(for_rival_); }

bool Tally::ConfidentBut(std::span<const int> rivals) const {
  int for_others = 0;
  for (const int label : voted_) {
    const auto i = static_cast<std::size_t>(label);
    if (label == leader_ || term_of_[i] != terms_ || votes_in_term_[i] <= for_others) continue;
    if (std::find(rivals.begin(), rivals.end(), label) == rivals.end()) {
      for_others = votes_in_term_[i];
    }
  }
  return Enough(for_others);
}

}  // namespace recollect::wnn
