#pragma once

#include <span>
#include <vector>

#include "recollect/cnn/pair_errors.h"

namespace recollect::cnn {

// The pose that several answers for one live image agree on best: each `world_from_live` errs by
// Exp(x), x ~ N(0, covariance), rad and m in the live camera's axes; what the others contradict
// counts little (Cauchy, at two standard deviations). At least one answer.
struct PoseAnswer {
  SE3 world_from_live;
  Matrix6d covariance;
};
SE3 FuseAnswers(std::span<const PoseAnswer> answers);

// Errors of the answers from the nearest key frame, from the nearest two together, and so on up to
// `most`; element i is of i + 1 key frames. All over the same live frames, those that are in as
// many pairs of `data`; "no motion" is the nearest key frame's. Answers without a covariance count
// as having errors of 0.01 rad and 0.3 m. Throws Error where no live frame has so many.
std::vector<PairErrors> EvaluateNearest(const PoseNetwork& network, const PairData& data, int most,
                                        const ProgressSink& progress = {});

}  // namespace recollect::cnn
