#pragma once

#include <span>
#include <vector>

namespace recollect::wnn {

// Answers kept at a threshold on their score: `precision` of the kept ones are right, and `recall`
// of all images are kept and right.
struct PrecisionPoint {
  double threshold = 0;
  double precision = 0;
  double recall = 0;
};

struct PrecisionCurve {
  std::vector<PrecisionPoint> points;  // by falling threshold, one a distinct score
  double auc = 0;                      // area under precision over recall, by trapezoids
  double recall_at_100_precision = 0;  // the highest recall with no wrong answer kept
};

// scores[i]: how much is thought of answer i; right[i]: whether it is right. Throws Error where
// there are none or not as many of one as of the other.
PrecisionCurve MakePrecisionCurve(std::span<const double> scores, const std::vector<bool>& right);

}  // namespace recollect::wnn
