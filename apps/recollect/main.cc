// recollect: the command line. Exits 0 when all went well, 1 with one line on standard error when
// something failed, 2 for wrong usage.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <exception>

#include "commands.h"
#include "recognition_commands.h"
#include "recollect/core/error.h"

int main(int argc, char** argv) {
  CLI::App app("Visual global localisation: where was this image taken?", "recollect");
  app.require_subcommand(1);
  app.set_version_flag("--version", RECOLLECT_VERSION);
  using namespace recollect::app;
  AddCompare(app);
  AddDataset(app);
  AddDemo(app);
  AddDepth(app);
  AddDepthEval(app);
  AddEvaluate(app);
  AddExperiment(app);
  AddLocalize(app);
  AddMap(app);
  AddModel(app);
  AddBench(app);
  AddPlaces(app);
  AddSimulate(app);
  AddTrain(app);
  AddTune(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "recollect: {}\n", error.what());
    return 1;
  }
  return 0;
}
