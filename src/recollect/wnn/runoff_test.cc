#include "recollect/wnn/runoff.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "recollect/core/random.h"

namespace recollect::wnn {
namespace {

// Chance of `yes` among `asked` of `size` voters of whom `total` are for it.
double Hypergeometric(int size, int total, int asked, int yes) {
  const auto log_choose = [](int n, int k) {
    return std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0);
  };
  if (yes > total || asked - yes > size - total) return 0;
  return std::exp(log_choose(total, yes) + log_choose(size - total, asked - yes) -
                  log_choose(size, asked));
}

// The same by trying all pairs of totals with a not ahead.
double ByTrying(const Stratum& a, const Stratum& b) {
  double least = std::numeric_limits<double>::infinity();
  for (int x = 0; x <= a.size; ++x) {
    for (int y = std::max(0, x + a.votes - b.votes); y <= b.size; ++y) {
      const double p = Hypergeometric(a.size, x, a.asked, a.yes) * (a.asked + 1) *
                       Hypergeometric(b.size, y, b.asked, b.yes) * (b.asked + 1);
      if (p > 0) least = std::min(least, -std::log(p));
    }
  }
  return least;
}

TEST(Runoff, EvidenceIsThatOfTheMostSuitableTotals) {
  Random random(1);
  for (int round = 0; round < 300; ++round) {
    Stratum strata[2];
    for (Stratum& s : strata) {
      s.votes = static_cast<int>(random.Index(10));
      s.size = static_cast<int>(random.Index(30));
      s.asked = static_cast<int>(random.Index(s.size + 1));
      s.yes = static_cast<int>(random.Index(s.asked + 1));
    }
    const double expected = ByTrying(strata[0], strata[1]);
    const double evidence = LogEvidenceAhead(strata[0], strata[1]);
    if (std::isinf(expected)) {
      EXPECT_TRUE(std::isinf(evidence) && evidence > 0);
    } else {
      EXPECT_NEAR(evidence, expected, 1e-8) << round;
    }
  }
}

// Two candidates with exactly equal totals: whenever evidence for either exceeds log(1 / alpha)
// at any time, that is an error; a share of at most alpha of all orders may have one.
TEST(Runoff, ErrsNoMoreOftenThanPromised) {
  const int size[2] = {120, 90}, yes[2] = {60, 60}, rounds = 3000;
  const double alpha = 0.05;
  Random random(2);
  int errors = 0;
  for (int round = 0; round < rounds; ++round) {
    Stratum strata[2];
    for (int s = 0; s < 2; ++s) strata[s].size = size[s];
    bool wrong = false;
    for (int step = 0; step < 85 && !wrong; ++step) {
      for (int s = 0; s < 2; ++s) {
        const double left = yes[s] - strata[s].yes, unread = size[s] - strata[s].asked;
        strata[s].yes += random.Uniform() * unread < left;
        ++strata[s].asked;
      }
      wrong = LogEvidenceAhead(strata[0], strata[1]) >= std::log(1 / alpha);
    }
    errors += wrong;
  }
  EXPECT_LT(errors, rounds * alpha + 4 * std::sqrt(rounds * alpha));
  EXPECT_GT(errors, 0);  // a bound that never errs asks too many
}

TEST(Runoff, IsCertainOnceTotalsAre) {
  const Stratum a{.votes = 10, .size = 20, .asked = 20, .yes = 15};
  EXPECT_GT(LogEvidenceAhead(a, {.votes = 4, .size = 20, .asked = 20, .yes = 20}), 1e9);
  EXPECT_LT(LogEvidenceAhead(a, {.votes = 5, .size = 20, .asked = 20, .yes = 20}), 0.1);
  EXPECT_GT(LogEvidenceAhead(a, {.votes = 4, .size = 20, .asked = 0, .yes = 0}), 1e9);
}

}  // namespace
}  // namespace recollect::wnn
