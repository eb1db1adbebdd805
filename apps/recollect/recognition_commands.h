#pragma once

#include <CLI/CLI.hpp>

// The sub-commands that choose and judge configurations of the weightless network.
namespace recollect::app {

void AddExperimentAblation(CLI::App& experiment);
void AddExperimentPlaces(CLI::App& experiment);
void AddTune(CLI::App& app);

}  // namespace recollect::app
