#pragma once

#include <functional>

#include "recollect/cnn/rank_options.h"

namespace recollect::app {

// Runs `body` in `ranks` processes of this machine, the first of them this one; when it returns all
// have ended. To be called while this process has one thread. Throws what `body` throws here, and
// Error when another rank fails.
void RunLocalRanks(int ranks, const std::function<void(const cnn::RankOptions&)>& body);

}  // namespace recollect::app
