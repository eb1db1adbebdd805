#pragma once

#include <cstddef>
#include <vector>

#include "recollect/geometry/se3.h"

namespace recollect {

// Absolute and relative errors of a trajectory, as the tool `evo` (github.com/MichaelGrupp/evo)
// defines them. Estimates and reference are poses of the same moments, in one world: align them
// before (alignment.h) where they are not. All functions throw Error for lists of different
// lengths and for nothing to compare.

// What is measured of an error pose E.
enum class PoseRelation {
  kTranslationPart,     // |t|, metres
  kRotationPart,        // |R - I|, Frobenius norm, no unit
  kRotationAngle,       // angle of R, radians
  kFullTransformation,  // |E - I|, Frobenius norm of the 4x4 matrix, no unit
};

struct ErrorStatistics {
  double rmse = 0, mean = 0, median = 0, std = 0, min = 0, max = 0;
  double sse = 0;  // sum of squares
};
// `std` is that of the whole population. Throws Error for no errors.
ErrorStatistics StatisticsOf(std::vector<double> errors);

// Absolute pose error (ATE, APE): of E_i = estimate_i^-1 reference_i, one value a pose.
std::vector<double> AbsoluteErrors(const std::vector<SE3>& reference,
                                   const std::vector<SE3>& estimate, PoseRelation relation);

enum class DeltaUnit { kFrames, kMetres };

struct RelativeErrorOptions {
  PoseRelation relation = PoseRelation::kTranslationPart;
  double delta = 1;  // how far apart the two poses of a pair are; a whole number of frames
  DeltaUnit unit = DeltaUnit::kFrames;
  // Every pose begins a pair, not only the last of the pair before. With metres the pair ends where
  // the path length comes nearest to delta, and is dropped when that is off by more than
  // tolerance * delta.
  bool all_pairs = false;
  double tolerance = 0.1;
  bool pairs_from_reference = false;  // take path lengths from the reference, not the estimate
};

// Relative pose error (RPE): of E = (ref_i^-1 ref_j)^-1 (est_i^-1 est_j), one value a pair.
std::vector<double> RelativeErrors(const std::vector<SE3>& reference,
                                   const std::vector<SE3>& estimate,
                                   const RelativeErrorOptions& options = {});

}  // namespace recollect
