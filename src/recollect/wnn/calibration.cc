#include "recollect/wnn/calibration.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "recollect/core/error.h"

namespace recollect::wnn {
namespace {

constexpr double kFloors[] = {0.001, 0.002, 0.005, 0.01, 0.02, 0.05};
constexpr double kTrusts[] = {0.5, 0.75, 1, 1.5, 2, 3, 4, 6, 8, 11, 16};
constexpr double kSharpnesses[] = {0.25, 0.5, 1, 2, 3, 4, 6, 8};
constexpr double kSequenceTrusts[] = {0.125, 0.25, 0.5, 1, 2, 4, 8};  // and sharpnesses
constexpr std::size_t kShortestRun = 5;                               // images that make a sequence
constexpr double kPrecisions[] = {0.5, 0.8, 0.9, 0.95, 0.98, 0.99, 0.995};
constexpr double kSmallest = 1e-6;  // chances are kept this far from 0 and 1
constexpr double kNowhere = 0.1;    // what an image from nowhere counts beside one from the route
constexpr double kPrior = 0.1;      // pull of the weights towards (0, 1, 0), in trials

double Sigmoid(double x) { return 1 / (1 + std::exp(-x)); }
double LogOdds(double p) {
  p = std::clamp(p, kSmallest, 1 - kSmallest);
  return std::log(p / (1 - p));
}

struct Features {
  int place = -1;
  Eigen::Vector3d x;
};

Features FeaturesOf(const VoteModel& model, const Route& route,
                    std::span<const LabelVotes> histogram, int neurons) {
  std::vector<double> belief = Likelihood(model, route, {histogram, neurons, {}, {}});
  double sum = 0;
  for (const double one : belief) sum += one;
  for (double& one : belief) one /= sum;
  Features features;
  features.place = Supported(route, histogram);
  double within = 0;
  for (int place = 0; place < route.places(); ++place) {
    if (route.WithinOne(features.place, place)) within += belief[static_cast<std::size_t>(place)];
  }
  const std::vector<double> support = Support(route, histogram);
  const double most = *std::max_element(support.begin(), support.end());
  features.x = {1, LogOdds(within), std::log(most / std::max(1, neurons) + kSmallest)};
  return features;
}

bool IsRight(const Trial& trial, int place) {
  return std::find(trial.right.begin(), trial.right.end(), place) != trial.right.end();
}

// What fitting needs of a trial: places that any vote speaks for, and how many there are besides.
struct Supporters {
  struct Place {
    double support = 0, own = 0;  // shares of the neurons
    bool right = false;
  };
  std::vector<Place> places;
  double others = 0, others_right = 0;
};

Supporters SupportersOf(const Route& route, const Trial& trial) {
  const std::vector<double> support = Support(route, trial.histogram);
  const double neurons = std::max(1, trial.neurons);
  std::vector<double> own(support.size(), 0);
  for (const LabelVotes& one : trial.histogram) {
    own[static_cast<std::size_t>(one.label)] = one.votes / neurons;
  }
  const std::vector<int>& truth = trial.exact.empty() ? trial.right : trial.exact;
  Supporters supporters;
  for (int place = 0; place < route.places(); ++place) {
    const auto i = static_cast<std::size_t>(place);
    if (support[i] > 0) {
      supporters.places.push_back({support[i] / neurons, own[i],
                                   std::find(truth.begin(), truth.end(), place) != truth.end()});
    }
  }
  supporters.others = static_cast<double>(support.size() - supporters.places.size());
  supporters.others_right = static_cast<double>(truth.size());
  for (const auto& place : supporters.places) supporters.others_right -= place.right ? 1 : 0;
  return supporters;
}

// Sum of the log likelihoods of the truth; Likelihood, without the places that are all alike.
double Fit(const std::vector<Supporters>& trials, const VoteModel& model) {
  double sum = 0;
  for (const Supporters& trial : trials) {
    const double other = std::pow(model.floor, model.trust + model.sharpness);
    double right = other * trial.others_right, all = other * trial.others;
    for (const Supporters::Place& place : trial.places) {
      const double likelihood = std::exp(model.trust * std::log(place.support + model.floor) +
                                         model.sharpness * std::log(place.own + model.floor));
      all += likelihood;
      if (place.right) right += likelihood;
    }
    sum += std::log(std::max(right / all, kSmallest));
  }
  return sum;
}

VoteModel FitVotes(const Route& route, std::span<const Trial> trials) {
  std::vector<Supporters> supporters;
  for (const Trial& trial : trials) {
    if (!trial.right.empty()) supporters.push_back(SupportersOf(route, trial));
  }
  VoteModel best;
  double most = -std::numeric_limits<double>::infinity();
  for (const double floor : kFloors) {
    for (const double trust : kTrusts) {
      for (const double sharpness : kSharpnesses) {
        const VoteModel model{floor, trust, sharpness};
        const double fit = Fit(supporters, model);
        if (fit <= most) continue;
        most = fit;
        best = model;
      }
    }
  }
  return best;
}

// Trials whose places follow each other, on a road that another lap has seen: how images of another
// day err together is not told by changed copies of one day's.
std::vector<std::vector<const Trial*>> RunsOf(const Route& route, std::span<const Trial> trials) {
  std::vector<std::vector<const Trial*>> runs;
  int last = -1;
  for (const Trial& trial : trials) {
    if (trial.place < 0 || trial.exact.empty()) continue;
    const bool follows = last >= 0 && route.next[static_cast<std::size_t>(last)] == trial.place;
    if (!follows) runs.emplace_back();
    runs.back().push_back(&trial);
    last = trial.place;
  }
  std::erase_if(runs, [](const auto& run) { return run.size() < kShortestRun; });
  return runs;
}

// Sum of the logarithms of what a filter believes of the truth.
double BeliefInTruth(const Route& route, const std::vector<std::vector<const Trial*>>& runs,
                     const VoteModel& votes) {
  const auto filter = MakeSequence({.history = 0, .votes = votes}, route);
  double sum = 0;
  for (const auto& run : runs) {
    filter->Reset();
    for (const Trial* trial : run) {
      const auto belief = filter->Update({trial->histogram, trial->neurons, {}, {}});
      double right = 0;
      for (const int place : trial->exact) right += belief[static_cast<std::size_t>(place)];
      sum += std::log(std::max(right, kSmallest));
    }
  }
  return sum;
}

VoteModel FitSequence(const Route& route, std::span<const Trial> trials) {
  const auto runs = RunsOf(route, trials);
  VoteModel best;
  if (runs.empty()) return best;
  double most = -std::numeric_limits<double>::infinity();
  for (const double trust : kSequenceTrusts) {
    for (const double sharpness : kSequenceTrusts) {
      const VoteModel model{best.floor, trust, sharpness};
      const double fit = BeliefInTruth(route, runs, model);
      if (fit <= most) continue;
      most = fit;
      best = model;
    }
  }
  return best;
}

// A live image's features, whether its answer was right, and what it counts.
struct Example {
  Eigen::Vector3d x;
  bool right = false;
  double weight = 1;
};

// Newton's method on the penalised log likelihood of a logistic model.
Eigen::Vector3d Logistic(const std::vector<Example>& examples) {
  const Eigen::Vector3d prior(0, 1, 0);
  Eigen::Vector3d w = prior;
  for (int step = 0; step < 50; ++step) {
    Eigen::Vector3d gradient = kPrior * (w - prior);
    Eigen::Matrix3d hessian = kPrior * Eigen::Matrix3d::Identity();
    for (const auto& [x, right, weight] : examples) {
      const double p = Sigmoid(w.dot(x));
      gradient += weight * (p - (right ? 1 : 0)) * x;
      hessian += weight * std::max(p * (1 - p), kSmallest) * x * x.transpose();
    }
    const Eigen::Vector3d change = hessian.ldlt().solve(gradient);
    w -= change * std::min(1.0, 2 / (change.norm() + kSmallest));
    if (change.norm() < 1e-9) break;
  }
  return w;
}

double Apply(const Calibration& calibration, const Eigen::Vector3d& x) {
  return Sigmoid(Eigen::Map<const Eigen::Vector3d>(calibration.weights).dot(x));
}

}  // namespace

Judged Judge(const Calibration& calibration, const Route& route,
             std::span<const LabelVotes> histogram, int neurons) {
  if (histogram.empty()) return {};
  const Features features = FeaturesOf(calibration.votes, route, histogram, neurons);
  return {features.place, Apply(calibration, features.x)};
}

Calibration Calibrate(const Route& route, std::span<const Trial> trials) {
  Require(
      std::any_of(trials.begin(), trials.end(), [](const Trial& t) { return !t.right.empty(); }),
      "calibration", "no trial lies on the route");
  Calibration calibration;
  calibration.trials = static_cast<int>(trials.size());
  calibration.votes = FitVotes(route, trials);
  calibration.sequence = FitSequence(route, trials);
  std::vector<Example> examples;
  std::vector<Features> features;
  for (const Trial& trial : trials) {
    features.push_back(FeaturesOf(calibration.votes, route, trial.histogram, trial.neurons));
    examples.push_back({features.back().x, IsRight(trial, features.back().place),
                        trial.right.empty() ? kNowhere : 1});
  }
  Eigen::Map<Eigen::Vector3d>(calibration.weights) = Logistic(examples);

  std::vector<double> found, nowhere;  // probabilities of either kind of trial
  std::vector<std::pair<double, bool>> judged;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const double p = Apply(calibration, features[i].x);
    if (trials[i].right.empty()) {
      nowhere.push_back(p);
    } else {
      judged.emplace_back(p, IsRight(trials[i], features[i].place));
    }
  }
  std::sort(judged.begin(), judged.end(), std::greater<>());
  for (const double precision : kPrecisions) {
    double threshold = 1;
    int kept = 0, correct = 0;
    for (const auto& [p, is_right] : judged) {
      ++kept;
      correct += is_right;
      const auto strangers = std::count_if(nowhere.begin(), nowhere.end(),
                                           [p = p](double other) { return other >= p; });
      if (static_cast<double>(strangers) > (1 - precision) * static_cast<double>(nowhere.size())) {
        break;
      }
      if (correct >= precision * kept) threshold = p;
    }
    calibration.thresholds.push_back({precision, threshold});
  }
  return calibration;
}

double ThresholdFor(const Calibration& calibration, double precision) {
  for (const auto& one : calibration.thresholds) {
    if (one.precision >= precision) return one.probability;
  }
  return 1;
}

}  // namespace recollect::wnn
