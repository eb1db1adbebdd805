#include "recollect/wnn/calibration.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "recollect/core/error.h"

namespace recollect::wnn {
namespace {

constexpr double kSequenceTrusts[] = {0.125, 0.25, 0.5, 1, 2, 4, 8};  // and sharpnesses
constexpr std::size_t kShortestRun = 5;                               // images that make a sequence
constexpr double kPrecisions[] = {0.5, 0.8, 0.9, 0.95, 0.98, 0.99, 0.995};
constexpr double kSmallest = 1e-6;  // chances are kept this far from 0 and 1
constexpr double kNowhere = 0.03;   // what an image from nowhere counts beside one of the route
constexpr double kCopy = 0.01;      // a changed copy of a mapped image beside another lap's
constexpr double kPrior = 0.1;      // pull of the weights towards their default, in trials
constexpr double kVote = 0.01;      // share of the neurons that any place is granted for its rival
constexpr double kDoubt = 4;  // times the wanted share of wrong answers that one kept may be unsure

double Sigmoid(double x) { return 1 / (1 + std::exp(-x)); }

struct Features {
  int place = -1;
  Eigen::Vector3d x;
};

Features FeaturesOf(const Route& route, std::span<const LabelVotes> histogram, int neurons) {
  Features features;
  features.place = Supported(route, histogram);
  const double all = std::max(1, neurons);
  double own = 0, rival = 0;
  for (const LabelVotes& one : histogram) {
    double& most = route.WithinOne(features.place, one.label) ? own : rival;
    most = std::max<double>(most, one.votes);
  }
  const std::vector<double> support = Support(route, histogram);
  const double most = *std::max_element(support.begin(), support.end());
  const auto& beside = route.beside[static_cast<std::size_t>(features.place)];
  const double laps = 1 + static_cast<double>(beside.size());
  features.x = {1, std::log((own + kVote * all) / (rival + kVote * all)),
                std::log(most / laps / all + kSmallest)};
  return features;
}

bool IsRight(const Trial& trial, int place) {
  return std::find(trial.right.begin(), trial.right.end(), place) != trial.right.end();
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

// A live image's features, whether what is asked holds of it, and what it counts.
struct Example {
  Eigen::Vector3d x;
  bool holds = false;
  double weight = 1;
};

// Minus the penalised log likelihood of a logistic model.
double Loss(const std::vector<Example>& examples, const Eigen::Vector3d& w,
            const Eigen::Vector3d& prior) {
  double loss = kPrior / 2 * (w - prior).squaredNorm();
  for (const auto& [x, holds, weight] : examples) {
    const double z = holds ? w.dot(x) : -w.dot(x);
    loss += weight * (z > 0 ? std::log1p(std::exp(-z)) : std::log1p(std::exp(z)) - z);
  }
  return loss;
}

// Newton's method on it, with steps halved until they help.
void Logistic(const std::vector<Example>& examples, Calibration::Weights& weights) {
  Eigen::Map<Eigen::Vector3d> w(weights.data());
  const Eigen::Vector3d prior = w;
  for (int step = 0; step < 100; ++step) {
    Eigen::Vector3d gradient = kPrior * (w - prior);
    Eigen::Matrix3d hessian = kPrior * Eigen::Matrix3d::Identity();
    for (const auto& [x, holds, weight] : examples) {
      const double p = Sigmoid(w.dot(x));
      gradient += weight * (p - (holds ? 1 : 0)) * x;
      hessian += weight * p * (1 - p) * x * x.transpose();
    }
    Eigen::Vector3d change = hessian.ldlt().solve(gradient);
    const double loss = Loss(examples, w, prior);
    while (change.norm() > 1e-9 && Loss(examples, w - change, prior) > loss) change /= 2;
    if (change.norm() <= 1e-9) break;
    w -= change;
  }
}

double Apply(const Calibration& calibration, const Eigen::Vector3d& x) {
  return Sigmoid(Eigen::Map<const Eigen::Vector3d>(calibration.right.data()).dot(x)) *
         Sigmoid(Eigen::Map<const Eigen::Vector3d>(calibration.here.data()).dot(x));
}

// `found`: probabilities of trials of the route, and whether they were right; `nowhere`: of others,
// seen by the same camera on the same road: strangers can look surer, so these alone lower nothing
// without end.
double Threshold(double precision, const std::vector<std::pair<double, bool>>& found,
                 const std::vector<double>& nowhere) {
  const double allowed = std::ceil((1 - precision) * static_cast<double>(nowhere.size()));
  double threshold = precision;
  int kept = 0, correct = 0;
  for (const auto& [p, is_right] : found) {
    ++kept;
    correct += is_right;
    const auto strangers =
        std::count_if(nowhere.begin(), nowhere.end(), [p = p](double other) { return other >= p; });
    if (static_cast<double>(strangers) > allowed) break;
    if (correct >= precision * kept) threshold = std::min(threshold, p);
  }
  return std::max(threshold, 1 - kDoubt * (1 - precision));
}

}  // namespace

Judged Judge(const Calibration& calibration, const Route& route,
             std::span<const LabelVotes> histogram, int neurons) {
  if (histogram.empty()) return {};
  const Features features = FeaturesOf(route, histogram, neurons);
  return {features.place, Apply(calibration, features.x)};
}

Calibration Calibrate(const Route& route, std::span<const Trial> trials) {
  Require(
      std::any_of(trials.begin(), trials.end(), [](const Trial& t) { return !t.right.empty(); }),
      "calibration", "no trial lies on the route");
  Calibration calibration;
  calibration.trials = static_cast<int>(trials.size());
  calibration.sequence = FitSequence(route, trials);
  std::vector<Example> right, here;
  for (const Trial& trial : trials) {
    if (trial.histogram.empty()) continue;
    const Features features = FeaturesOf(route, trial.histogram, trial.neurons);
    const bool on_route = !trial.right.empty();
    const double weight = trial.copy ? kCopy : 1;
    if (on_route) right.push_back({features.x, IsRight(trial, features.place), weight});
    here.push_back({features.x, on_route, weight * (on_route ? 1 : kNowhere)});
  }
  Logistic(right, calibration.right);
  Logistic(here, calibration.here);

  std::vector<std::pair<double, bool>> found;
  std::vector<double> nowhere;
  for (const Example& one : right) {
    const bool copy = one.weight < 1;  // which does not prove that a lower threshold would do
    if (!copy) found.emplace_back(Apply(calibration, one.x), one.holds);
  }
  for (const Example& one : here) {
    if (!one.holds) nowhere.push_back(Apply(calibration, one.x));
  }
  std::sort(found.begin(), found.end(), std::greater<>());
  for (const double precision : kPrecisions) {
    calibration.thresholds.push_back({precision, Threshold(precision, found, nowhere)});
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
