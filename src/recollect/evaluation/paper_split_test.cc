#include "recollect/evaluation/paper_split.h"

#include <gtest/gtest.h>

#include "recollect/core/error.h"
#include "recollect/core/files.h"
#include "recollect/testing/scratch_folder.h"

namespace recollect {
namespace {

namespace fs = std::filesystem;
using Laps = std::vector<std::size_t>;

std::vector<Lap> Named(const std::vector<std::string>& names) {
  std::vector<Lap> laps;
  for (const std::string& name : names) {
    laps.emplace_back().name = name;
    laps.back().folder = fs::path("nowhere") / name;
  }
  return laps;
}

TEST(ChooseSplit, LeavesTheLastLapOut) {
  const PaperSplit split = ChooseSplit(Named({"a", "b", "c"}));
  EXPECT_EQ(split.map, (Laps{0, 1}));
  EXPECT_EQ(split.train, split.map);
  EXPECT_EQ(split.test, 2u);
  EXPECT_FALSE(split.valid);
  EXPECT_FALSE(split.of_the_paper);
  EXPECT_EQ(RoleOf(split, 2), "live");
  EXPECT_EQ(RoleOf(split, 0), "mapped, trained on");
}

TEST(ChooseSplit, IsThePapersForItsRecordings) {
  const auto laps =
      Named({"20140418", "20160825", "20160825-01", "20160825-02", "20160830", "20161021",
             "20170119", "20171122", "20171205", "20180112", "20180112-02"});
  const PaperSplit split = ChooseSplit(laps);
  EXPECT_TRUE(split.of_the_paper);
  EXPECT_EQ(split.map, (Laps{1, 2, 3, 8, 9, 10}));
  EXPECT_EQ(split.train, (Laps{1, 2, 3, 5, 8, 9, 10}));
  EXPECT_EQ(split.valid, 4u);
  EXPECT_EQ(split.test, 7u);
  EXPECT_EQ(RoleOf(split, 5), "trained on");
  EXPECT_EQ(RoleOf(split, 6), "not used");
}

TEST(ChooseSplit, KnowsRenderedLapsOfTheRouteByWhatTheySay) {
  const testing::ScratchFolder folder;
  auto laps = Named({"lap-01", "lap-04", "lap-05", "lap-07"});
  EXPECT_EQ(ChooseSplit(laps).map, (Laps{0, 1, 2}));
  for (Lap& lap : laps) {
    lap.folder = folder / lap.name;
    AtomicWrite(lap.folder / "lap.txt",
                "rendered, not recorded: lap 1 of the simulated route ufes\n");
  }
  const PaperSplit split = ChooseSplit(laps);
  EXPECT_TRUE(IsSimulated(laps[0]));
  EXPECT_EQ(split.map, (Laps{0}));
  EXPECT_EQ(split.train, (Laps{0, 2}));
  EXPECT_EQ(split.valid, 1u);
  EXPECT_EQ(split.test, 3u);
}

TEST(ChooseSplit, TakesNamesAndNumbers) {
  const auto laps = Named({"lap-01", "lap-02", "lap-03", "lap-12"});
  const PaperSplit split = ChooseSplit(laps, {.map = {"12", "lap-02"}, .valid = "1", .test = "03"});
  EXPECT_EQ(split.map, (Laps{3, 1}));
  EXPECT_EQ(split.valid, 0u);
  EXPECT_EQ(split.test, 2u);
}

TEST(ChooseSplit, RefusesWhatCannotBe) {
  const auto laps = Named({"lap-01", "lap-02"});
  EXPECT_THROW(ChooseSplit({}), Error);
  EXPECT_THROW(ChooseSplit(Named({"a"})), Error);
  EXPECT_THROW(ChooseSplit(laps, {{}, "", "lap-09"}), Error);
  EXPECT_THROW(ChooseSplit(laps, {{"1"}, "", "1"}), Error);
  EXPECT_THROW(ChooseSplit(laps, {{"1"}, "1", ""}), Error);
  EXPECT_THROW(ChooseSplit(laps, {{}, "2", "2"}), Error);
}

}  // namespace
}  // namespace recollect
