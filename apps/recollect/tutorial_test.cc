// docs/tutorial.md, followed to the letter by someone with two drives of images and poses.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "recollect/core/error.h"
#include "recollect/core/files.h"
#include "recollect/testing/scratch_folder.h"
#include "recollect/testing/street.h"

namespace recollect {
namespace {

namespace fs = std::filesystem;

// The lines of the page's one block of commands.
std::vector<std::string> CommandsOf(const std::string& page) {
  const std::string open = "```sh\n", close = "```";
  const std::size_t begin = page.find(open) + open.size();
  std::istringstream block(page.substr(begin, page.find(close, begin) - begin));
  std::vector<std::string> commands;
  for (std::string line; std::getline(block, line);) commands.push_back(line);
  return commands;
}

int Shell(const std::string& command, const fs::path& folder) {
  return std::system(fmt::format("cd '{}' && {} >>log 2>&1", folder.string(), command).c_str());
}

TEST(Tutorial, CommandsLeadToAReport) {
  if (!fs::exists(fs::path(RECOLLECT_BUILD) / "report.html")) {
    GTEST_SKIP() << "the page of reports was not built (apt-get install nodejs npm; make build)";
  }
  const testing::ScratchFolder folder;
  for (int lap = 1; lap <= 2; ++lap) {
    const fs::path drive = folder / "my-laps" / fmt::format("lap-{}", lap);
    testing::DriveStreet(
        drive, {.length_m = 24, .lateral_m = 0.3 * lap, .seed = static_cast<std::uint64_t>(lap)});
    fs::remove_all(drive / "depth");  // a stranger has images and poses
    fs::remove(drive / "times.txt");
  }
  fs::create_directory_symlink(RECOLLECT_BUILD, folder / "build");

  const std::vector<std::string> commands = CommandsOf(ReadFile("docs/tutorial.md"));
  ASSERT_GE(commands.size(), 2u);
  ASSERT_LE(commands.size(), 5u);
  EXPECT_EQ(commands.front(), "make build");  // what made this test; only that it is there
  EXPECT_EQ(Shell("true", folder.path()), 0);
  EXPECT_EQ(std::system("make --dry-run build >/dev/null 2>&1"), 0);
  for (std::size_t i = 1; i < commands.size(); ++i) {
    EXPECT_EQ(Shell(commands[i], folder.path()), 0) << commands[i] << '\n'
                                                    << ReadFile(folder / "log");
  }
  EXPECT_GT(fs::file_size(folder / "my-report" / "report.html"), 100'000u);
  const auto run = nlohmann::json::parse(ReadFile(folder / "my-report" / "run.json"));
  EXPECT_EQ(run["images"], "real");
  EXPECT_EQ(run["frames"]["frame"].size(), 24u);
  const std::string log = ReadFile(folder / "log");
  EXPECT_NE(log.find("key frame"), std::string::npos) << log;  // localize's answer
}

}  // namespace
}  // namespace recollect
