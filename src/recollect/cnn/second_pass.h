#pragma once

#include "recollect/cnn/pair_errors.h"

namespace recollect::cnn {

// Errors where each pair of `data` is asked twice: the first answer tells where the live frame is,
// and the key frame nearest to there that looks the same way (within 60 degrees) is asked again.
// What the first key frame's pose errs by is the "no motion" of both.
PairErrors EvaluateSecondPass(const PoseNetwork& network, const PairData& data,
                              const ProgressSink& progress = {});

}  // namespace recollect::cnn
