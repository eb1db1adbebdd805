#include "recollect/wnn/precision.h"

#include <algorithm>
#include <numeric>

#include "recollect/core/error.h"

namespace recollect::wnn {

PrecisionCurve MakePrecisionCurve(std::span<const double> scores, const std::vector<bool>& right) {
  Require(!scores.empty() && scores.size() == right.size(), "precision",
          "as many scores as answers are needed, and at least one");
  std::vector<std::size_t> order(scores.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return scores[a] > scores[b]; });
  PrecisionCurve curve;
  const auto all = static_cast<double>(scores.size());
  double correct = 0, last_precision = 1, last_recall = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    correct += right[order[i]];
    if (i + 1 < order.size() && scores[order[i + 1]] == scores[order[i]]) continue;
    const PrecisionPoint point{scores[order[i]], correct / static_cast<double>(i + 1),
                               correct / all};
    if (curve.points.empty()) last_precision = point.precision;
    curve.auc += (point.recall - last_recall) * (point.precision + last_precision) / 2;
    last_precision = point.precision;
    last_recall = point.recall;
    if (correct == static_cast<double>(i + 1)) curve.recall_at_100_precision = point.recall;
    curve.points.push_back(point);
  }
  return curve;
}

}  // namespace recollect::wnn
