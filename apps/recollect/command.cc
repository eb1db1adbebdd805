#include "command.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <memory>

#include "recollect/core/files.h"
#include "recollect/core/stopwatch.h"

namespace recollect::app {

CLI::App* AddCommand(CLI::App& parent, const std::string& name, const std::string& description,
                     Common& common, std::function<void()> run) {
  CLI::App* command = parent.add_subcommand(name, description);
  command->add_option("--json", common.json, "write the figures to this file")->type_name("FILE");
  command->add_option("--threads", common.threads, "threads to use; 0: one for each core")
      ->check(CLI::Range(0, 1024));
  command->add_option("--seed", common.seed, "seed of everything random")->capture_default_str();
  command->callback(std::move(run));
  return command;
}

void WriteFigures(const Common& common, const nlohmann::json& figures) {
  if (!common.json.empty()) AtomicWrite(common.json, figures.dump(2) + "\n");
}

std::string CommandLine() {
  const std::string arguments = ReadFile("/proc/self/cmdline");
  std::string line;
  for (std::size_t at = 0; at < arguments.size();) {
    const std::string argument = arguments.c_str() + at;
    at += argument.size() + 1;
    const bool plain =
        !argument.empty() && argument.find_first_of(" \t\"'$\\;&|<>*?()") == std::string::npos;
    line += (line.empty() ? "" : " ") + (plain ? argument : "'" + argument + "'");
  }
  return line;
}

std::filesystem::path ProgramFolder() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

ProgressSink TerminalProgress() {
  if (isatty(STDERR_FILENO) == 0) return {};
  struct State {
    std::string stage;
    Stopwatch since_start, since_line;
  };
  return [state = std::make_shared<State>()](const Progress& progress) {
    const bool begins = progress.stage != state->stage;
    const bool ends = progress.total > 0 && progress.done >= progress.total;
    if (begins) {
      state->stage = progress.stage;
      state->since_start.Restart();
    }
    if (!begins && !ends && state->since_line.Seconds() < 0.2) return;
    state->since_line.Restart();
    const double seconds = state->since_start.Seconds();
    const double rate = seconds > 0 ? static_cast<double>(progress.done) / seconds : 0;
    std::string line = fmt::format("\r\033[K{} {}", progress.stage, progress.done);
    if (progress.total > 0) {
      line += fmt::format("/{}", progress.total);
      if (rate > 0) {
        const auto left = static_cast<double>(progress.total - progress.done) / rate;
        line += fmt::format("  {:.1f}/s  {:.0f} s left", rate, left);
      }
    }
    fmt::print(stderr, "{}  {}{}", line, progress.detail, ends ? "\n" : "");
    std::fflush(stderr);
  };
}

}  // namespace recollect::app
