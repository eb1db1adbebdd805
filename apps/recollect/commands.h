#pragma once

#include <CLI/CLI.hpp>

// One function a sub-command, each in the file of its name.
namespace recollect::app {

void AddCompare(CLI::App& app);
void AddDataset(CLI::App& app);
void AddDemo(CLI::App& app);
void AddDepth(CLI::App& app);
void AddDepthEval(CLI::App& app);
void AddEvaluate(CLI::App& app);
void AddExperiment(CLI::App& app);
void AddExperimentPairs(CLI::App& experiment);
void AddExperimentPaper(CLI::App& experiment);
void AddLocalize(CLI::App& app);
void AddMap(CLI::App& app);
void AddModel(CLI::App& app);
void AddBench(CLI::App& app);
void AddPlaces(CLI::App& app);
void AddSimulate(CLI::App& app);
void AddTrain(CLI::App& app);

}  // namespace recollect::app
