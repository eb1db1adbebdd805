#pragma once

#include <span>
#include <vector>

namespace recollect::wnn {

// Counts the committee's votes one neuron at a time and says when enough of them are in. What is
// said of chances needs the neurons to come in random order (Synapses numbers them so); what is
// said to be certain needs nothing.
class Tally {
 public:
  // labels: votes are for 0 .. labels - 1. neurons: votes that there are in all. error_bound: the
  // chance, over the order of neurons, that Confident() ever holds of a label that will not win.
  Tally(int labels, int neurons, double error_bound);

  void Add(int label);

  int read() const { return read_; }
  // The label with most votes so far, of equals the lowest; -1 before the first vote.
  int leader() const { return leader_; }
  int votes(int label) const { return votes_[static_cast<std::size_t>(label)]; }
  // Labels that got votes, in no order worth naming.
  std::span<const int> voted() const { return voted_; }

  // The leader wins whatever the votes still to come.
  bool Certain() const;
  // The leader wins, but for a chance of at most error_bound. See docs/search.md, "Anytime".
  bool Confident() const;
  // The same of the leader and `rivals`: one of them wins.
  bool ConfidentBut(std::span<const int> rivals) const;

 private:
  // A label that bets against all that might win instead of it, from a fixed time on.
  struct Nominee {
    int label;
    double log_stake;             // its share of all stakes
    std::size_t round;            // index of the counts at its nomination
    std::vector<int> overtakers;  // labels that had more votes at some time since; itself
  };
  void Nominate();
  // Whether label `rival`, or any label with at most `most[round]` votes since each nomination that
  // overtook no nominee, has lost.
  bool Lost(std::span<const int> most, int rival) const;

  int neurons_;
  double log_bound_;
  std::vector<int> votes_;  // by label
  std::vector<int> voted_;
  int read_ = 0;
  int leader_ = -1;
  int second_ = 0;      // votes of the best label but the leader
  int next_round_ = 0;  // votes at the next nominations
  std::vector<Nominee> nominees_;
  std::vector<std::vector<int>> votes_at_;  // by round of nominations, by label
};

// Evidence, as a betting score, that a vote for a or b goes to a more often than not: a fair bet
// against "a gets at most half of them" has multiplied its stake by exp of this after `a` votes for
// the one and `b` for the other. Natural logarithm.
double LogEvidence(int a, int b);

}  // namespace recollect::wnn
