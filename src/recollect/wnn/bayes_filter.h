#pragma once

#include <deque>
#include <vector>

#include "recollect/wnn/sequence.h"

namespace recollect::wnn {

void Normalise(std::vector<double>& weights);  // to a sum of 1

// Discrete Bayes filter over (place, speed). Speed is in places an image, unknown at first and
// changing slowly; a fraction of a place is passed with that chance. What an image tells is news
// only as far as one has moved: who stands still sees the same again, right or wrong. So where one
// stands, creeps or moves by less than a place, its likelihood counts with the square root of the
// places passed for a power, a tenth at least. Powers differ with the speed, so they would tell
// speeds apart by themselves; which speed it is is told by one power for all. With a history of n
// images the belief is that of the last n alone, found afresh from "anywhere" each time; only the
// speed is remembered.
class BayesFilter final : public Sequence {
 public:
  BayesFilter(const SequenceOptions& options, const Route& route);
  std::vector<double> Update(const Observation& observation) override;
  void Reset() override;

 private:
  struct Step {
    std::vector<std::vector<double>> likelihoods;  // by share of news, see shares_
    std::optional<double> moved;
  };
  using State = std::vector<std::vector<double>>;  // [speed][place], sums to 1

  Step Seen(const Observation& observation) const;
  State Anywhere() const;
  void RememberSpeed();
  void Predict(State& state, std::optional<double> moved) const;
  void Correct(State& state, const Step& step) const;
  // Weights moved `places` along the route, forwards or backwards.
  std::vector<double> Moved(const std::vector<double>& weights, double places) const;

  SequenceOptions options_;
  Route route_;
  std::vector<double> speeds_;
  std::vector<double> shares_;  // of an image's likelihood that may be news, the largest first
  std::vector<std::size_t> share_of_;  // by speed, an index into shares_
  std::vector<double> usual_;          // by speed, its chance before anything is known
  std::vector<double> remembered_;     // and after what was seen
  State state_;
  std::deque<Step> steps_;  // the last `history`
};

}  // namespace recollect::wnn
