#include <fmt/format.h>

#include <memory>

#include "command.h"
#include "commands.h"
#include "recollect/evaluation/data_tables.h"

namespace recollect::app {
namespace {

struct ExperimentFlags {
  Common common;
  std::string name;
  std::filesystem::path data;
};

void RunExperiment(const ExperimentFlags& flags) {
  const DataTables tables = ComputeDataTables(flags.data);
  fmt::print("{}", Describe(tables));
  WriteFigures(flags.common, ToJson(tables));
}

}  // namespace

void AddExperiment(CLI::App& app) {
  auto flags = std::make_shared<ExperimentFlags>();
  CLI::App* command = AddCommand(app, "experiment", "Repeat an experiment of the paper",
                                 flags->common, [flags] { RunExperiment(*flags); });
  command->add_option("name", flags->name, "tables: the paper's data tables and baselines")
      ->required()
      ->check(CLI::IsMember({"tables"}));
  command->add_option("--data", flags->data, "the data set: for tables, the folder of UFES-LAPS")
      ->type_name("DIR")
      ->required();
}

}  // namespace recollect::app
