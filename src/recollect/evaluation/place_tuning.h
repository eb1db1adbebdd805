#pragma once

#include <functional>
#include <string>
#include <vector>

#include "recollect/evaluation/place_trials.h"
#include "recollect/wnn/network.h"

namespace recollect {

// Choosing a configuration of the weightless network by trials on mapped laps alone: one question
// after the other, each about one thing, the answers kept before the next is asked.

// Another way to do one thing.
struct TuneAnswer {
  std::string flags;  // of `map create` and `places`
  std::function<void(wnn::NetworkOptions& network)> apply;
};
struct TuneQuestion {
  std::string about;
  std::vector<TuneAnswer> answers;  // besides how the recommended configuration does it
};
// All that is tried, in this order.
std::vector<TuneQuestion> TuneQuestions();

struct Tried {
  std::string about, flags;    // these beside the ones kept so far
  std::vector<double> shares;  // of trials answered right, by seed
  Estimate gain;               // over what was kept so far, seed by seed
  bool kept = false;
};
struct Tuned {
  wnn::NetworkOptions network;  // seed: the first
  std::string flags;            // that make it; empty: the recommended configuration stays
  std::vector<double> start;    // shares of the recommended configuration, by seed
  std::vector<double> shares;   // and of what was chosen
  std::vector<Tried> tried;
};

// `score`: the share right, of a configuration with its seed (TrialScore). An answer is kept where
// its gain is above zero by half the width of its 95 % interval, and by `least` in any case: chance
// chooses nothing, and one seed not much. `seeds` >= 1, from first_seed on. `tell` hears of each.
Tuned Tune(const std::vector<TuneQuestion>& questions,
           const std::function<double(const wnn::NetworkOptions& network)>& score, int seeds,
           std::uint64_t first_seed, const std::function<void(const Tried& tried)>& tell = {},
           double least = 0.01);

}  // namespace recollect
