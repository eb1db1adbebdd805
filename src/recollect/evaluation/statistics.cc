#include "recollect/evaluation/statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "recollect/core/error.h"

namespace recollect {
namespace {

double QuantileOfSorted(const std::vector<double>& sorted, double q) {
  if (sorted.empty()) return 0;
  const double place = q * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], place - std::floor(place));
}

std::vector<double> Sorted(std::vector<double> values) {
  for (const double value : values) Require(!std::isnan(value), "statistics", "a value is NaN");
  std::sort(values.begin(), values.end());
  return values;
}

}  // namespace

double Quantile(std::vector<double> values, double q) {
  Require(q >= 0 && q <= 1, "quantile", fmt::format("{} is not in [0, 1]", q));
  return QuantileOfSorted(Sorted(std::move(values)), q);
}

Summary Summarise(const std::vector<double>& values) {
  if (values.empty()) return {};
  const std::vector<double> sorted = Sorted(values);
  const double sum = std::accumulate(sorted.begin(), sorted.end(), 0.0);
  return {sorted.size(),
          sum / static_cast<double>(sorted.size()),
          QuantileOfSorted(sorted, 0.5),
          QuantileOfSorted(sorted, 0.75),
          QuantileOfSorted(sorted, 0.95),
          sorted.back()};
}

Box BoxOf(const std::vector<double>& values) {
  if (values.empty()) return {};
  const std::vector<double> sorted = Sorted(values);
  Box box;
  box.q1 = QuantileOfSorted(sorted, 0.25);
  box.median = QuantileOfSorted(sorted, 0.5);
  box.q3 = QuantileOfSorted(sorted, 0.75);
  const double reach = 1.5 * (box.q3 - box.q1);
  box.low = *std::lower_bound(sorted.begin(), sorted.end(), box.q1 - reach);
  box.high = *std::prev(std::upper_bound(sorted.begin(), sorted.end(), box.q3 + reach));
  return box;
}

}  // namespace recollect
