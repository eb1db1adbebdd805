#include "recollect/wnn/tally.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "recollect/core/random.h"

namespace recollect::wnn {
namespace {

std::vector<int> Shuffled(const std::vector<int>& votes_by_label, Random& random) {
  std::vector<int> votes;
  for (std::size_t label = 0; label < votes_by_label.size(); ++label) {
    votes.insert(votes.end(), static_cast<std::size_t>(votes_by_label[label]),
                 static_cast<int>(label));
  }
  for (std::size_t i = votes.size(); i > 1; --i) {
    std::swap(votes[i - 1], votes[static_cast<std::size_t>(random.Index(static_cast<int>(i)))]);
  }
  return votes;
}

TEST(LogEvidence, IsTheIntegralItStandsFor) {
  for (const auto& [a, b] : {std::pair{0, 0}, {1, 0}, {5, 5}, {20, 3}, {3, 20}, {400, 350}}) {
    double integral = 0;
    const int steps = 200000;
    for (int i = 0; i < steps; ++i) {
      const double p = 0.5 + 0.5 * (i + 0.5) / steps;
      integral += std::exp(a * std::log(2 * p) + b * std::log(2 * (1 - p))) / steps;
    }
    EXPECT_NEAR(LogEvidence(a, b), std::log(integral), 1e-6) << a << " " << b;
  }
  EXPECT_TRUE(std::isfinite(LogEvidence(5000, 184)));
}

TEST(LogEvidence, GrowsWithVotesForAndFallsWithVotesAgainst) {
  for (int n = 1; n < 200; ++n) {
    EXPECT_GT(LogEvidence(n + 1, 50), LogEvidence(n, 50));
    EXPECT_LT(LogEvidence(50, n + 1), LogEvidence(50, n));
  }
}

TEST(Tally, LeaderIsAlwaysTheMostVotedTheLowestOfEquals) {
  Random random(1);
  for (int round = 0; round < 200; ++round) {
    Tally tally(6, 100, 1e-4);
    std::vector<int> votes(6, 0);
    for (int n = 0; n < 100; ++n) {
      const int label = static_cast<int>(random.Index(6));
      ++votes[static_cast<std::size_t>(label)];
      tally.Add(label);
      const auto best = std::max_element(votes.begin(), votes.end());
      ASSERT_EQ(tally.leader(), best - votes.begin());
      // Certain exactly when giving all votes to come to any other label changes nothing.
      bool certain = true;
      for (int l = 0; l < 6; ++l) {
        const int most = votes[static_cast<std::size_t>(l)] + 99 - n;
        if (l != tally.leader() && most >= *best) certain = false;
      }
      ASSERT_EQ(tally.Certain(), certain);
    }
  }
}

// The promise under the worst votes: two labels exactly equal, so that a stop on label 1 at any
// time is an error (of equals the lowest wins). Its share must stay below the bound.
TEST(Tally, ErrsNoMoreOftenThanPromisedWhenLabelsTie) {
  const double bound = 0.05;
  const int rounds = 1000;
  Random random(2);
  for (const auto& population : {std::vector<int>{200, 200}, {60, 60, 60, 60}, {150, 151, 99}}) {
    const int neurons = std::accumulate(population.begin(), population.end(), 0);
    const auto most = std::max_element(population.begin(), population.end());
    const int winner = static_cast<int>(most - population.begin());
    int errors = 0;
    for (int round = 0; round < rounds; ++round) {
      Tally tally(static_cast<int>(population.size()), neurons, bound);
      for (const int vote : Shuffled(population, random)) {
        tally.Add(vote);
        if (!tally.Confident()) continue;
        errors += tally.leader() != winner;
        break;
      }
    }
    EXPECT_LT(errors, rounds * bound + 4 * std::sqrt(rounds * bound));
  }
}

// Two labels that take turns in the lead keep no one from ruling out the rest.
TEST(Tally, RulesOutTheRestWhileTheFirstTwoAreLevel) {
  std::vector<int> population(400, 3);
  population[7] = population[9] = 600;
  Random random(4);
  double read = 0;
  for (int round = 0; round < 20; ++round) {
    Tally tally(400, 2394, 1e-4);
    for (const int vote : Shuffled(population, random)) {
      tally.Add(vote);
      if (tally.ConfidentBut(std::vector<int>{7, 9})) break;
    }
    EXPECT_FALSE(tally.Confident());
    read += tally.read() / 20.0;
  }
  EXPECT_LT(read, 160);
}

TEST(Tally, ReadsFewVotesWhereTheWinnerIsClear) {
  std::vector<int> population(500, 4);
  population[7] = 3000;  // 3,000 votes for one label, 1,996 spread over the rest
  Random random(3);
  Tally tally(500, 4996, 1e-4);
  for (const int vote : Shuffled(population, random)) {
    tally.Add(vote);
    if (tally.Confident()) break;
  }
  EXPECT_EQ(tally.leader(), 7);
  EXPECT_LT(tally.read(), 100);
}

}  // namespace
}  // namespace recollect::wnn
