#include "recollect/wnn/runoff.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace recollect::wnn {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kMinStep = 16;  // neurons of a stratum asked before the matter is looked at again
constexpr int kGrain = 8;     // neurons that a thread takes at a time

double LogFactorial(int n) {
  static const std::vector<double> table = [] {
    std::vector<double> logs = {0};
    for (int i = 1; i < 1 << 14; ++i) logs.push_back(logs.back() + std::log(i));
    return logs;
  }();
  const auto i = static_cast<std::size_t>(n);
  return i < table.size() ? table[i] : std::lgamma(n + 1.0);
}

double LogChoose(int n, int k) { return LogFactorial(n) - LogFactorial(k) - LogFactorial(n - k); }

// Least and most votes that the stratum can yield.
int Least(const Stratum& s) { return s.yes; }
int Most(const Stratum& s) { return s.size - (s.asked - s.yes); }

// Evidence against "the stratum yields `total` votes": the uniform prior over its posterior.
double LogRatio(const Stratum& s, int total) {
  return LogChoose(s.size, s.asked) - std::log(s.asked + 1.0) - LogChoose(total, s.yes) -
         LogChoose(s.size - total, s.asked - s.yes);
}

// The total of least evidence against it, in [low, high]; the function is convex.
template <typename Function>
int ArgMin(int low, int high, const Function& f) {
  while (low < high) {
    const int middle = low + (high - low) / 2;
    if (f(middle) <= f(middle + 1)) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return low;
}

double Estimate(const Stratum& s) {
  // Laplace's rule, so that strata nobody was asked of count for half.
  const double rate = (s.yes + 1.0) / (s.asked + 2.0);
  return s.votes + s.yes + rate * (s.size - s.asked);
}

}  // namespace

double LogEvidenceAhead(const Stratum& a, const Stratum& b) {
  if (a.votes + Least(a) > b.votes + Most(b)) return kInfinity;
  const int best_a = ArgMin(Least(a), Most(a), [&](int total) { return LogRatio(a, total); });
  const int best_b = ArgMin(Least(b), Most(b), [&](int total) { return LogRatio(b, total); });
  if (a.votes + best_a <= b.votes + best_b) return LogRatio(a, best_a) + LogRatio(b, best_b);
  // The votes suggest that a is ahead: of all totals with a not ahead those with equal ones do
  // best.
  const int more = a.votes - b.votes;  // b's total is a's and this
  const int low = std::max(Least(a), Least(b) - more), high = std::min(Most(a), Most(b) - more);
  if (low > high) return kInfinity;
  const auto both = [&](int total) { return LogRatio(a, total) + LogRatio(b, total + more); };
  return both(ArgMin(low, high, both));
}

Verdict AskRunoff(const Memory& memory, Asking& asking, const Tally& tally,
                  const Candidates& candidates, double error_bound) {
  const std::vector<std::vector<int>> neurons = Peek(memory, asking, tally, candidates);
  const std::size_t count = candidates.labels.size();
  std::vector<Stratum> strata(count);
  for (std::size_t c = 0; c < count; ++c) {
    strata[c].votes = tally.votes(candidates.labels[c]);
    strata[c].size = static_cast<int>(neurons[c].size());
  }
  const auto ask = [&](std::size_t c) {
    Stratum& s = strata[c];
    const int step = std::min(s.size - s.asked, std::max(kMinStep, s.asked / 8));
    const std::span<const int> portion(neurons[c].data() + s.asked, static_cast<std::size_t>(step));
    asking.Ask(portion, kGrain);
    for (const int n : portion) s.yes += memory.label(asking.entry(n)) == candidates.labels[c];
    s.asked += step;
  };
  const auto ahead = [&](std::size_t a, std::size_t b) {  // of equals the lowest label wins
    const double x = Estimate(strata[a]), y = Estimate(strata[b]);
    return x > y || (x == y && candidates.labels[a] < candidates.labels[b]);
  };

  std::size_t leader = 0;
  double second = 0;
  for (;;) {
    leader = 0;
    for (std::size_t c = 1; c < count; ++c) {
      if (ahead(c, leader)) leader = c;
    }
    // The shares of the chance to err, 1/2, 1/6, 1/12 ... by rank at first, sum to one.
    const auto rank = static_cast<double>(leader);
    const double stake = (rank + 1) * (rank + 2) / error_bound;
    double least = kInfinity;
    std::size_t rival = leader;
    second = 0;
    for (std::size_t c = 0; c < count; ++c) {
      if (c == leader) continue;
      second = std::max(second, Estimate(strata[c]));
      const bool settled =
          strata[c].asked == strata[c].size && strata[leader].asked == strata[leader].size;
      const double evidence = settled ? kInfinity : LogEvidenceAhead(strata[leader], strata[c]);
      if (evidence < least) {
        least = evidence;
        rival = c;
      }
    }
    if (rival == leader || least >= std::log(stake)) break;
    ask(leader);
    ask(rival);
  }
  for (std::size_t c = 0; c < count; ++c) {
    for (std::size_t i = static_cast<std::size_t>(strata[c].asked); i < neurons[c].size(); ++i) {
      asking.Forget(neurons[c][i]);
    }
  }
  const double first = Estimate(strata[leader]);
  return {candidates.labels[leader], std::max(0.0, first - second) / first};
}

}  // namespace recollect::wnn
