#pragma once

#include <CLI/CLI.hpp>

#include "recollect/depth/matcher.h"

namespace recollect::app {

// The flags of the stereo methods that depth and depth-eval share.
void AddStereoFlags(CLI::App& command, stereo::MatchOptions& options);

}  // namespace recollect::app
