#include <fmt/format.h>
#include <unistd.h>

#include <memory>

#include "command.h"
#include "commands.h"
#include "recollect/core/error.h"
#include "recollect/dataset/reader.h"
#include "recollect/evaluation/html_report.h"
#include "recollect/evaluation/paper.h"
#include "recollect/evaluation/run_text.h"
#include "wnn_flags.h"

namespace recollect::app {
namespace {

struct PaperFlags {
  Common common;
  std::string format = "guess", network = "compact";
  double minutes = 0;
  PaperOptions paper;
  CLI::App* command = nullptr;
};

constexpr const char* kNone = "none";

cnn::TrainOptions TrainOptionsOf(const PaperFlags& flags) {
  if (flags.network == kNone) return {};
  const cnn::NetworkKind kind = cnn::NetworkKindFromName(flags.network);
  cnn::TrainOptions train = kind == cnn::NetworkKind::kCompact ? cnn::TrainOptions::Compact()
                                                               : cnn::TrainOptions::Paper(kind);
  train.minutes = flags.minutes;
  return train;
}

void Run(PaperFlags flags) {
  PaperOptions& paper = flags.paper;
  const std::vector<std::string> recogniser = flags.command->get_option("--wnn")->results();
  if (!recogniser.empty()) paper.recogniser_name = recogniser.back();
  paper.train = TrainOptionsOf(flags);
  paper.network = flags.network != kNone;
  paper.recogniser.seed = paper.stamp.seed = paper.statistics.bootstrap.seed = flags.common.seed;
  paper.threads = flags.common.threads;
  paper.stamp.command = CommandLine();
  paper.stamp.versions["recollect"] = RECOLLECT_VERSION;
  paper.page_template = ProgramFolder() / kReportTemplate;
  const nlohmann::json run =
      RunPaper(ReadLaps(paper.data, ParseFormat(flags.format)), paper, TerminalProgress());
  fmt::print("{}\nReport: {}\n", FormatRun(run), (paper.out / "report.html").string());
  WriteFigures(flags.common, run);
}

}  // namespace

void AddExperimentPaper(CLI::App& experiment) {
  auto flags = std::make_shared<PaperFlags>();
  CLI::App* command =
      AddCommand(experiment, "paper",
                 "The paper's evaluation from laps to a report; takes up where it stopped",
                 flags->common, [flags] { Run(*flags); });
  flags->command = command;
  PaperOptions& paper = flags->paper;
  command->add_option("--data", paper.data, "folder of laps (docs/data.md)")
      ->type_name("DIR")
      ->required();
  command->add_option("--out", paper.out, "folder for the report and all that leads to it")
      ->type_name("DIR")
      ->required();
  command->add_option("--format", flags->format, "what the folder holds: guess, kitti, tum or ufes")
      ->capture_default_str();
  command
      ->add_option(
          "--images", paper.images,
          "whether they are real or rendered; laps of recollect simulate say so themselves")
      ->check(CLI::IsMember({"real", "rendered"}));
  command
      ->add_option(
          "--map-laps", paper.laps.map,
          "laps to map and to train on, names or numbers; default: the paper's where these\n"
          "are UFES-LAPS, else all but the live one")
      ->delimiter(',');
  command->add_option("--test-lap", paper.laps.test,
                      "the live lap; default: the paper's, else the last");
  command->add_option("--validation-lap", paper.laps.valid,
                      "lap to validate the training on; default: the paper's, else a tenth of the\n"
                      "road");
  AddWnnFlags(*command, paper.recogniser);
  command
      ->add_option("--network", flags->network, "to train: a, b or compact; none: geometry alone")
      ->capture_default_str();
  command->add_option("--minutes", flags->minutes, "time limit of the training; 0: none")
      ->capture_default_str();
  command->add_option("--model", paper.model, "a trained network, instead of training one")
      ->type_name("FILE")
      ->check(CLI::ExistingFile);
  command->add_option("--curve", paper.curve, "its training curve, by train --csv")
      ->type_name("FILE")
      ->check(CLI::ExistingFile)
      ->needs("--model");
  command->add_option("--every", paper.evaluation.every, "localise each so many-th live image")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command->add_option("--live-spacing", paper.live_spacing_m,
                      "metres between live images; default: 1, all of laps that were rendered by\n"
                      "recollect simulate");
  command->add_option("--spacing", paper.spacing_m, "metres between key frames of a lap")
      ->capture_default_str();
  command
      ->add_option("--segment", paper.statistics.segment_m,
                   "metres of road that intervals are drawn by")
      ->capture_default_str();
  command
      ->add_option("--published", paper.published,
                   "the folder of UFES-LAPS, for the paper's own tables and real GPS beside")
      ->type_name("DIR");
}

}  // namespace recollect::app
