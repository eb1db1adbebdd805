#include <fmt/format.h>

#include <memory>

#include "command.h"
#include "commands.h"
#include "recollect/evaluation/run_compare.h"

namespace recollect::app {
namespace {

struct CompareFlags {
  Common common;
  std::vector<std::filesystem::path> files;
};

// A run is known by the folder that its run.json lies in.
std::string NameOf(const std::filesystem::path& file) {
  const auto folder = std::filesystem::absolute(file).parent_path().filename().string();
  return file.filename() == "run.json" ? folder : file.stem().string();
}

void Run(const CompareFlags& flags) {
  std::vector<nlohmann::json> runs;
  std::vector<std::string> names;
  for (const auto& file : flags.files) {
    runs.push_back(ReadRun(file));
    names.push_back(NameOf(file));
  }
  const nlohmann::json comparison = CompareRuns(runs, names, {.seed = flags.common.seed});
  fmt::print("{}", FormatComparison(comparison));
  WriteFigures(flags.common, comparison);
}

}  // namespace

void AddCompare(CLI::App& app) {
  auto flags = std::make_shared<CompareFlags>();
  CLI::App* command = AddCommand(app, "compare", "Put runs of experiment paper side by side",
                                 flags->common, [flags] { Run(*flags); });
  command->add_option("runs", flags->files, "their run.json files; the first is compared with")
      ->type_name("RUN")
      ->required();
}

}  // namespace recollect::app
