#pragma once

#include <CLI/CLI.hpp>

namespace recollect::app {

void AddExperimentLabels(CLI::App& experiment);

}  // namespace recollect::app
