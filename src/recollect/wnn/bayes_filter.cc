#include "recollect/wnn/bayes_filter.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "recollect/core/error.h"

namespace recollect::wnn {
namespace {

// Places an image: standing, creeping between far-apart key frames, up to passing several at once.
constexpr double kSpeeds[] = {0, 0.1, 0.2, 0.35, 0.6, 1, 1.5, 2.2, 3.2, 4.5};
constexpr double kSpeedChange = 0.05;  // chance that speed goes one step up or down
constexpr double kLeastNews = 0.1;     // share of an image's likelihood that counts without moving
constexpr double kRemember = 0.05;     // what the newest image counts in the speed remembered
constexpr double kForget = 0.1;        // chance that the speed remembered is of no use

double News(double places) { return std::clamp(std::sqrt(std::abs(places)), kLeastNews, 1.0); }

// Who takes images of a road moves along it: up to a place an image, the faster the likelier.
double Usual(double speed) { return std::clamp(std::abs(speed), 0.1, 1.0); }

}  // namespace

BayesFilter::BayesFilter(const SequenceOptions& options, const Route& route)
    : options_(options), route_(route) {
  if (options.backwards) {
    for (const double speed : kSpeeds) {
      if (speed > 0) speeds_.insert(speeds_.begin(), -speed);
    }
  }
  speeds_.insert(speeds_.end(), std::begin(kSpeeds), std::end(kSpeeds));
  for (const double speed : speeds_) {
    shares_.push_back(News(speed));
    usual_.push_back(Usual(speed));
  }
  Normalise(usual_);
  std::sort(shares_.begin(), shares_.end(), std::greater<>());
  shares_.erase(std::unique(shares_.begin(), shares_.end()), shares_.end());
  for (const double speed : speeds_) {
    const auto share = std::find(shares_.begin(), shares_.end(), News(speed));
    share_of_.push_back(static_cast<std::size_t>(share - shares_.begin()));
  }
  Reset();
}

void BayesFilter::Reset() {
  state_.clear();
  steps_.clear();
  remembered_ = usual_;
}

BayesFilter::State BayesFilter::Anywhere() const {
  State state;
  for (std::size_t s = 0; s < speeds_.size(); ++s) {
    const double chance = (1 - kForget) * remembered_[s] + kForget * usual_[s];
    state.emplace_back(route_.next.size(), chance / static_cast<double>(route_.next.size()));
  }
  return state;
}

void BayesFilter::RememberSpeed() {
  for (std::size_t s = 0; s < speeds_.size(); ++s) {
    const double chance = std::accumulate(state_[s].begin(), state_[s].end(), 0.0);
    remembered_[s] += kRemember * (chance - remembered_[s]);
  }
}

std::vector<double> BayesFilter::Moved(const std::vector<double>& weights, double places) const {
  const std::vector<int>& ahead = places >= 0 ? route_.next : route_.before;
  std::vector<double> from = weights, to(weights.size());
  for (double left = std::abs(places); left > 0; left -= 1) {
    const double share = std::min(left, 1.0);
    std::fill(to.begin(), to.end(), 0.0);
    for (std::size_t i = 0; i < from.size(); ++i) {
      const double moving = ahead[i] >= 0 ? share : 0;  // the road's end holds what reaches it
      to[i] += (1 - moving) * from[i];
      if (ahead[i] >= 0) to[static_cast<std::size_t>(ahead[i])] += moving * from[i];
    }
    std::swap(from, to);
  }
  return from;
}

void BayesFilter::Predict(State& state, std::optional<double> moved) const {
  const std::size_t speeds = speeds_.size(), places = route_.next.size();
  State next(speeds);
  for (std::size_t s = 0; s < speeds; ++s) {
    // Speed first, then place, then the lap that is followed. Left alone, speeds become the usual.
    const std::size_t below = s == 0 ? s : s - 1, above = s + 1 == speeds ? s : s + 1;
    const auto changes = [&](std::size_t from, std::size_t to) {
      return from == to ? 0 : kSpeedChange / 2 * std::min(1.0, usual_[to] / usual_[from]);
    };
    const double stay = 1 - changes(s, below) - changes(s, above);
    const double up = changes(below, s), down = changes(above, s);
    std::vector<double> mixed(places);
    for (std::size_t i = 0; i < places; ++i) {
      mixed[i] = stay * state[s][i] + up * state[below][i] + down * state[above][i];
    }
    mixed = Moved(mixed, moved ? *moved : speeds_[s]);
    next[s].assign(places, options_.jump / static_cast<double>(speeds * places));
    for (std::size_t i = 0; i < places; ++i) {
      const double kept = (1 - options_.jump) * mixed[i];
      const auto& beside = route_.beside[i];
      const double leaving = beside.empty() ? 0 : options_.change_lap;
      next[s][i] += (1 - leaving) * kept;
      for (const int other : beside) {
        next[s][static_cast<std::size_t>(other)] +=
            leaving * kept / static_cast<double>(beside.size());
      }
    }
  }
  state = std::move(next);
}

// Powers of likelihoods have a mean of one over all places: what tells nothing moves nothing.
BayesFilter::Step BayesFilter::Seen(const Observation& observation) const {
  const std::vector<double> likelihood = Likelihood(options_.votes, route_, observation);
  Step step{{}, observation.moved};
  const std::vector<double> moved = {observation.moved ? News(*observation.moved) : 1};
  for (const double share : observation.moved ? moved : shares_) {
    std::vector<double> power(likelihood.size());
    std::transform(likelihood.begin(), likelihood.end(), power.begin(),
                   [share](double one) { return std::pow(one, share); });
    const double mean =
        std::accumulate(power.begin(), power.end(), 0.0) / static_cast<double>(power.size());
    for (double& one : power) one /= mean;
    step.likelihoods.push_back(std::move(power));
  }
  return step;
}

void BayesFilter::Correct(State& state, const Step& step) const {
  const bool known = step.likelihoods.size() == 1;  // how far one has moved
  double common = 0;                                // the power that tells speeds apart
  for (std::size_t s = 0; s < state.size() && !known; ++s) {
    common += shares_[share_of_[s]] * std::accumulate(state[s].begin(), state[s].end(), 0.0);
  }
  std::vector<double> tells = step.likelihoods.front();
  if (!known) {
    for (double& one : tells) one = std::pow(one, common);
  }
  double sum = 0;
  for (std::size_t s = 0; s < state.size(); ++s) {
    const auto& likelihood = step.likelihoods[known ? 0 : share_of_[s]];
    double evidence = 0, all = 0;
    for (std::size_t i = 0; i < likelihood.size(); ++i) {
      evidence += state[s][i] * tells[i];
      all += state[s][i] *= likelihood[i];
    }
    for (double& weight : state[s]) weight *= evidence / all;
    sum += evidence;
  }
  for (auto& places : state) {
    for (double& weight : places) weight /= sum;
  }
}

std::vector<double> BayesFilter::Update(const Observation& observation) {
  Step step = Seen(observation);
  if (options_.history > 0) {
    steps_.push_back(std::move(step));
    if (steps_.size() > static_cast<std::size_t>(options_.history)) steps_.pop_front();
    state_ = Anywhere();
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      if (i > 0) Predict(state_, steps_[i].moved);
      Correct(state_, steps_[i]);
    }
    RememberSpeed();
  } else {
    if (state_.empty()) {
      state_ = Anywhere();
    } else {
      Predict(state_, step.moved);
    }
    Correct(state_, step);
  }
  std::vector<double> belief(route_.next.size(), 0);
  for (const auto& places : state_) {
    for (std::size_t i = 0; i < belief.size(); ++i) belief[i] += places[i];
  }
  return belief;
}

}  // namespace recollect::wnn
