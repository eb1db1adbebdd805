// The folder of laps as a user meets it: whole or not there, and the same however it was made.
#include "recollect/simulation/simulate.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <fstream>

#include "recollect/core/error.h"
#include "recollect/core/files.h"
#include "recollect/dataset/reader.h"
#include "recollect/testing/scratch_folder.h"

namespace recollect::simulation {
namespace {

namespace fs = std::filesystem;

SimulateOptions Short(const fs::path& out) {
  SimulateOptions options;
  options.out = out;
  options.laps = "2";
  options.spacing = 10;
  options.every = 12;
  options.depth = true;
  options.threads = 2;
  return options;
}

TEST(Simulate, MakesLapsThatTheReaderTakes) {
  const testing::ScratchFolder folder;
  SimulateOptions options = Short(folder / "reads");
  options.stereo = true;
  const SimulateResult result = Simulate(options);
  const std::vector<Lap> laps = ReadLaps(options.out);
  ASSERT_EQ(laps.size(), 1U);
  EXPECT_EQ(static_cast<std::int64_t>(laps[0].frames.size()), result.rendered);
  EXPECT_EQ(laps[0].gps.size(), laps[0].frames.size());
  EXPECT_NEAR(laps[0].camera.baseline, 0.24004, 1e-4);
  EXPECT_FALSE(laps[0].frames[0].depth.empty());
  EXPECT_FALSE(laps[0].frames[0].right.empty());
  EXPECT_TRUE(fs::exists(options.out / "README.md"));
  EXPECT_TRUE(fs::exists(options.out / "lap-02" / "gps.nmea"));
  EXPECT_TRUE(fs::exists(options.out / "lap-02" / "odometry.csv"));
  const SimulateResult again = Simulate(options);
  EXPECT_EQ(again.rendered, 0);
  EXPECT_EQ(again.kept, result.rendered);
  fs::create_directories(options.out / ".lap-03.partial" / "image_2");  // another run at work
  EXPECT_EQ(ReadLaps(options.out).size(), 1U);
}

TEST(Simulate, GoesOnWhereItStopped) {
  const testing::ScratchFolder folder;
  const SimulateOptions whole = Short(folder / "whole"), parts = Short(folder / "parts");
  Simulate(whole);
  struct Stop {};
  EXPECT_THROW(Simulate(parts,
                        [](const Progress& p) {
                          if (p.done == 2) throw Stop();
                        }),
               Stop);
  EXPECT_FALSE(fs::exists(parts.out / "lap-02"));  // nothing that a reader would take for whole
  EXPECT_THROW(ReadLaps(parts.out), Error);
  const SimulateResult rest = Simulate(parts);
  EXPECT_GE(rest.kept, 2);
  for (const auto& entry : fs::recursive_directory_iterator(whole.out)) {
    if (!entry.is_regular_file()) continue;
    const fs::path twin = parts.out / fs::relative(entry.path(), whole.out);
    EXPECT_EQ(ReadFile(entry.path()), ReadFile(twin)) << twin;
  }
  SimulateOptions other = parts;
  other.change.strength = 0.5;
  EXPECT_THROW(Simulate(other), Error);  // it would mix two worlds
}

TEST(Simulate, DiskThatIsFull) {
  const testing::ScratchFolder folder;
  SimulateOptions options = Short(folder / "full");
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{20000, old.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  EXPECT_THROW(Simulate(options), Error);
  setrlimit(RLIMIT_FSIZE, &old);
  EXPECT_FALSE(fs::exists(options.out / "lap-02"));
  for (const auto& entry : fs::recursive_directory_iterator(options.out)) {
    EXPECT_NE(entry.path().extension(), ".jpg") << "a picture cut short: " << entry.path();
  }
  Simulate(options);  // room again: it completes
  EXPECT_EQ(ReadLaps(options.out).size(), 1U);
}

TEST(Simulate, FoldersThatCannotBeWritten) {
  const testing::ScratchFolder folder;
  const fs::path file = folder / "file";
  std::ofstream(file) << "not a folder";
  SimulateOptions options = Short(file / "laps");
  EXPECT_THROW(Simulate(options), Error);
  options = Short(folder / "taken");
  fs::create_directories(options.out / "lap-02");
  EXPECT_THROW(Simulate(options), Error);
}

TEST(Simulate, AbsurdOptions) {
  const auto refused = [](auto change) {
    const testing::ScratchFolder folder;
    SimulateOptions options = Short(folder / "absurd");
    change(options);
    EXPECT_THROW(Simulate(options), Error);
    EXPECT_FALSE(fs::exists(options.out));
  };
  refused([](SimulateOptions& o) { o.spacing = 0; });
  refused([](SimulateOptions& o) { o.spacing = std::nan(""); });
  refused([](SimulateOptions& o) { o.every = 0; });
  refused([](SimulateOptions& o) { o.baseline = -1; });
  refused([](SimulateOptions& o) { o.jpeg_quality = 1000; });
  refused([](SimulateOptions& o) { o.change.strength = 1e9; });
  refused([](SimulateOptions& o) { o.route = "moon"; });
  refused([](SimulateOptions& o) { o.route = "ufes:/nowhere"; });
  refused([](SimulateOptions& o) { o.laps = "0"; });
  refused([](SimulateOptions& o) { o.laps = "1,"; });
  refused([](SimulateOptions& o) { o.faults = "rust"; });
  refused([](SimulateOptions& o) { o.rolling_shutter = 3; });
}

TEST(ParseLaps, ListsAndRanges) {
  EXPECT_EQ(ParseLaps("3,1,5-7,6", 10), (std::vector<int>{1, 3, 5, 6, 7}));
  EXPECT_EQ(ParseLaps("all", 3), (std::vector<int>{1, 2, 3}));
  for (const char* wrong : {"", "x", "1-", "-2", "5-3", "11", "1,,2", "1.5"}) {
    EXPECT_THROW(ParseLaps(wrong, 10), Error) << wrong;
  }
}

}  // namespace
}  // namespace recollect::simulation
