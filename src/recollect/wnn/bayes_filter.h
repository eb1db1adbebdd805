#pragma once

#include <deque>
#include <vector>

#include "recollect/wnn/sequence.h"

namespace recollect::wnn {

void Normalise(std::vector<double>& weights);  // to a sum of 1

// Discrete Bayes filter over (place, speed). Speed is in places an image, unknown at first and
// changing slowly; a fraction of a place is passed with that chance. With a history of n images the
// belief is that of the last n alone, found afresh from "anywhere" each time.
class BayesFilter final : public Sequence {
 public:
  BayesFilter(const SequenceOptions& options, const Route& route);
  std::vector<double> Update(const Observation& observation) override;
  void Reset() override;

 private:
  struct Step {
    std::vector<double> likelihood;
    std::optional<double> moved;
  };
  using State = std::vector<std::vector<double>>;  // [speed][place], sums to 1

  State Anywhere() const;
  void Predict(State& state, std::optional<double> moved) const;
  void Correct(State& state, const std::vector<double>& likelihood) const;
  // Weights moved `places` along the route, forwards or backwards.
  std::vector<double> Moved(const std::vector<double>& weights, double places) const;

  SequenceOptions options_;
  Route route_;
  std::vector<double> speeds_;
  State state_;
  std::deque<Step> steps_;  // the last `history`
};

}  // namespace recollect::wnn
