#include <fmt/format.h>

#include <memory>

#include "command.h"
#include "commands.h"
#include "experiment_labels.h"
#include "recognition_commands.h"
#include "recollect/evaluation/data_tables.h"

namespace recollect::app {
namespace {

struct TablesFlags {
  Common common;
  std::filesystem::path data;
};

void RunTables(const TablesFlags& flags) {
  const DataTables tables = ComputeDataTables(flags.data);
  fmt::print("{}", Describe(tables));
  WriteFigures(flags.common, ToJson(tables));
}

void AddExperimentTables(CLI::App& experiment) {
  auto flags = std::make_shared<TablesFlags>();
  CLI::App* command = AddCommand(experiment, "tables", "The paper's data tables and baselines",
                                 flags->common, [flags] { RunTables(*flags); });
  command->add_option("--data", flags->data, "the folder of UFES-LAPS")
      ->type_name("DIR")
      ->required();
}

}  // namespace

void AddExperiment(CLI::App& app) {
  CLI::App* experiment = app.add_subcommand("experiment", "Repeat an experiment");
  experiment->require_subcommand(1);
  AddExperimentTables(*experiment);
  AddExperimentPairs(*experiment);
  AddExperimentPaper(*experiment);
  AddExperimentLabels(*experiment);
  AddExperimentPlaces(*experiment);
  AddExperimentAblation(*experiment);
}

}  // namespace recollect::app
