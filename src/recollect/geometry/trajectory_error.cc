#include "recollect/geometry/trajectory_error.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "recollect/core/error.h"

namespace recollect {
namespace {

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

double Measure(const SE3& error, PoseRelation relation) {
  switch (relation) {
    case PoseRelation::kTranslationPart:
      return error.translation().norm();
    case PoseRelation::kRotationPart:
      return (error.rotation() - Eigen::Matrix3d::Identity()).norm();
    case PoseRelation::kRotationAngle:
      return error.Angle();
    case PoseRelation::kFullTransformation:
      return (error.Matrix() - Eigen::Matrix4d::Identity()).norm();
  }
  throw Error("pose relation", "is none of those that exist");
}

Pairs Consecutive(const std::vector<std::size_t>& ids) {
  Pairs pairs;
  for (std::size_t n = 1; n < ids.size(); ++n) pairs.emplace_back(ids[n - 1], ids[n]);
  return pairs;
}

Pairs PairsByFrames(std::size_t count, const RelativeErrorOptions& options) {
  Require(options.delta >= 1 && options.delta == std::floor(options.delta), "delta",
          fmt::format("{} is no positive whole number of frames", options.delta));
  const auto delta = static_cast<std::size_t>(options.delta);
  Pairs pairs;
  for (std::size_t i = 0; i + delta < count; i += options.all_pairs ? 1 : delta) {
    pairs.emplace_back(i, i + delta);
  }
  return pairs;
}

Pairs PairsByPath(const std::vector<SE3>& poses, const RelativeErrorOptions& options) {
  Require(options.delta > 0, "delta", fmt::format("{} m is not positive", options.delta));
  const auto step = [&](std::size_t i) {
    return i == 0 ? 0 : (poses[i].translation() - poses[i - 1].translation()).norm();
  };
  if (!options.all_pairs) {
    // As in evo the first pose belongs to no pair: the first stretch begins there.
    std::vector<std::size_t> ids;
    double stretch = 0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      stretch += step(i);
      if (stretch < options.delta) continue;
      ids.push_back(i);
      stretch = 0;
    }
    return Consecutive(ids);
  }
  std::vector<double> path(poses.size(), 0);
  for (std::size_t i = 1; i < poses.size(); ++i) path[i] = path[i - 1] + step(i);
  Pairs pairs;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const auto miss = [&](double end) { return std::abs(end - path[i] - options.delta); };
    const auto nearest =
        std::min_element(path.begin() + static_cast<std::ptrdiff_t>(i) + 1, path.end(),
                         [&](double a, double b) { return miss(a) < miss(b); });
    if (miss(*nearest) <= options.tolerance * options.delta) {
      pairs.emplace_back(i, static_cast<std::size_t>(nearest - path.begin()));
    }
  }
  return pairs;
}

void RequireSameLength(const std::vector<SE3>& reference, const std::vector<SE3>& estimate) {
  Require(
      reference.size() == estimate.size() && !reference.empty(), "trajectory error",
      fmt::format("{} reference poses against {} estimates", reference.size(), estimate.size()));
}

}  // namespace

ErrorStatistics StatisticsOf(std::vector<double> errors) {
  Require(!errors.empty(), "trajectory error", "no errors to summarise");
  std::sort(errors.begin(), errors.end());
  const auto n = static_cast<double>(errors.size());
  const std::size_t middle = errors.size() / 2;
  ErrorStatistics statistics;
  statistics.sse = std::inner_product(errors.begin(), errors.end(), errors.begin(), 0.0);
  statistics.rmse = std::sqrt(statistics.sse / n);
  statistics.mean = std::accumulate(errors.begin(), errors.end(), 0.0) / n;
  statistics.median =
      errors.size() % 2 == 1 ? errors[middle] : (errors[middle - 1] + errors[middle]) / 2;
  double variance = 0;
  for (const double error : errors) variance += std::pow(error - statistics.mean, 2) / n;
  statistics.std = std::sqrt(variance);
  statistics.min = errors.front();
  statistics.max = errors.back();
  return statistics;
}

std::vector<double> AbsoluteErrors(const std::vector<SE3>& reference,
                                   const std::vector<SE3>& estimate, PoseRelation relation) {
  RequireSameLength(reference, estimate);
  std::vector<double> errors;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    errors.push_back(Measure(estimate[i].Inverse() * reference[i], relation));
  }
  return errors;
}

std::vector<double> RelativeErrors(const std::vector<SE3>& reference,
                                   const std::vector<SE3>& estimate,
                                   const RelativeErrorOptions& options) {
  RequireSameLength(reference, estimate);
  const Pairs pairs =
      options.unit == DeltaUnit::kFrames
          ? PairsByFrames(reference.size(), options)
          : PairsByPath(options.pairs_from_reference ? reference : estimate, options);
  Require(!pairs.empty(), "delta",
          fmt::format("no two poses are {} {} apart", options.delta,
                      options.unit == DeltaUnit::kFrames ? "frames" : "m"),
          "take a smaller one, or a larger tolerance");
  std::vector<double> errors;
  for (const auto& [i, j] : pairs) {
    const SE3 reference_motion = reference[i].Inverse() * reference[j];
    const SE3 estimate_motion = estimate[i].Inverse() * estimate[j];
    errors.push_back(Measure(reference_motion.Inverse() * estimate_motion, options.relation));
  }
  return errors;
}

}  // namespace recollect
