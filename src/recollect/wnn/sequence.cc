#include "recollect/wnn/sequence.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "recollect/core/error.h"
#include "recollect/wnn/bayes_filter.h"
#include "recollect/wnn/sabgl.h"

namespace recollect::wnn {
namespace {

class SingleImage final : public Sequence {
 public:
  SingleImage(const SequenceOptions& options, const Route& route)
      : options_(options), route_(route) {}
  std::vector<double> Update(const Observation& observation) override {
    std::vector<double> belief = Likelihood(options_.votes, route_, observation);
    Normalise(belief);
    return belief;
  }
  void Reset() override {}

 private:
  SequenceOptions options_;
  Route route_;
};

}  // namespace

void Normalise(std::vector<double>& weights) {
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) weight /= sum;
}

std::vector<double> Likelihood(const VoteModel& model, const Route& route,
                               const Observation& observation) {
  std::vector<double> support = Support(route, observation.histogram);
  const double neurons = std::max(1, observation.neurons);
  const double unvoted = std::pow(model.floor, model.sharpness);
  for (double& s : support) s = std::pow(s / neurons + model.floor, model.trust) * unvoted;
  const std::vector<double> steadiness = Steadiness(route, observation.histogram);
  for (std::size_t i = 0; i < steadiness.size(); ++i) {
    const LabelVotes& one = observation.histogram[i];
    support[static_cast<std::size_t>(one.label)] *=
        steadiness[i] * std::pow(one.votes / neurons + model.floor, model.sharpness) / unvoted;
  }
  return support;
}

std::unique_ptr<Sequence> MakeSequence(const SequenceOptions& options, const Route& route) {
  const std::string where = "sequence";
  Require(route.places() > 0, where, "a route without places");
  Require(options.history >= 0 && options.history <= 1000, where, "history must be 0 to 1000");
  Require(options.votes.floor > 0 && options.votes.trust > 0 && options.votes.sharpness >= 0, where,
          "floor and trust must be positive, sharpness not negative");
  Require(options.jump > 0 && options.jump < 1 && options.change_lap >= 0 && options.change_lap < 1,
          where, "chances must lie between 0 and 1");
  switch (options.filter) {
    case Filter::kNone:
      return std::make_unique<SingleImage>(options, route);
    case Filter::kSabgl:
      Require(options.history > 0, where, "SABGL needs a length of sequence");
      return std::make_unique<Sabgl>(options.history, route);
    case Filter::kBayes:
      break;
  }
  return std::make_unique<BayesFilter>(options, route);
}

PlaceBelief MostLikely(const Route& route, std::span<const double> belief,
                       std::span<const LabelVotes> histogram) {
  Require(static_cast<int>(belief.size()) == route.places(), "belief", "is of another route");
  PlaceBelief best;
  for (int place = 0; place < route.places(); ++place) {
    const auto i = static_cast<std::size_t>(place);
    double sum = 0;
    int likeliest = place;
    const auto add = [&](int p) {
      for (const int one : {p, route.next[static_cast<std::size_t>(p)],
                            route.before[static_cast<std::size_t>(p)]}) {
        if (one < 0) continue;
        const double own = belief[static_cast<std::size_t>(one)];
        sum += own;
        if (own > belief[static_cast<std::size_t>(likeliest)]) likeliest = one;
      }
    };
    add(place);
    for (const int other : route.beside[i]) add(other);
    if (sum > best.probability) best = {likeliest, std::min(1.0, sum)};
  }
  best.place = Outstanding(route, best.place, histogram, belief);
  return best;
}

}  // namespace recollect::wnn
