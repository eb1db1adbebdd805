#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "recollect/core/progress.h"

// What the files of this folder share: each adds one sub-command to the command line, maps its
// flags to the fields of an options struct, calls the library and shows what came of it.
namespace recollect::app {

// Flags that every sub-command takes.
struct Common {
  std::filesystem::path json;  // where to write the figures; empty: nowhere
  int threads = 0;             // 0: one for each core
  std::uint64_t seed = 1;
};

// Makes the sub-command `name` of `parent`, with the flags of Common, and runs `run` when it is
// the one called. Flags of its own are added to what this returns.
CLI::App* AddCommand(CLI::App& parent, const std::string& name, const std::string& description,
                     Common& common, std::function<void()> run);

// Writes the figures to common.json where that was asked for.
void WriteFigures(const Common& common, const nlohmann::json& figures);

// What was typed, as one line for a shell.
std::string CommandLine();

// Where the program itself lies.
std::filesystem::path ProgramFolder();

// A line on the terminal with stage, share done, rate and time left; quiet where standard error
// is not a terminal.
ProgressSink TerminalProgress();

}  // namespace recollect::app
