#include "recollect/evaluation/run_compare.h"

#include <gtest/gtest.h>

#include "recollect/core/error.h"
#include "recollect/core/files.h"
#include "recollect/testing/scratch_folder.h"

namespace recollect {
namespace {

using nlohmann::json;

// Four images, two to a segment; `errors` of one row, null for no answer.
json RunOf(const json& errors, const std::string& hash = "abc") {
  const json interval = {{"value", 1}, {"low", 0.5}, {"high", 2}};
  return {
      {"images", "rendered"},
      {"stamp", {{"data_hash", hash}, {"seed", 1}}},
      {"segments", {{"metres", 10}}},
      {"places", {{"systems", json::array()}}},
      {"rows",
       {{{"name", "pnp"},
         {"label", "WNN + PnP"},
         {"mean", interval},
         {"median", interval},
         {"p95", interval},
         {"availability", 1}}}},
      {"frames",
       {{"frame", {0, 1, 2, 3}}, {"distance_m", {0, 5, 10, 15}}, {"errors", {{"pnp", errors}}}}}};
}

TEST(CompareRuns, TakesDifferencesOnTheSameImages) {
  const json comparison =
      CompareRuns({RunOf({1, 2, 3, nullptr}), RunOf({2, 3, 3, 9})}, {"old", "new"});
  ASSERT_EQ(comparison["paired"].size(), 1u);
  const json& pair = comparison["paired"][0];
  EXPECT_EQ(pair["run"], "new");
  EXPECT_EQ(pair["frames"], 3);
  EXPECT_NEAR(pair["difference"]["value"].get<double>(), 2.0 / 3, 1e-12);
  // Segments: {1, 1} and {0}; a resample takes two of them.
  EXPECT_EQ(pair["difference"]["low"], 0);
  EXPECT_EQ(pair["difference"]["high"], 1);
  const std::string table = FormatComparison(comparison);
  EXPECT_NE(table.find("WNN + PnP"), std::string::npos);
  EXPECT_NE(table.find("rendered"), std::string::npos);
}

TEST(CompareRuns, OfOtherDataAreNotPaired) {
  EXPECT_TRUE(
      CompareRuns({RunOf({1, 1, 1, 1}), RunOf({1, 1, 1, 1}, "abd")}, {"a", "b"})["paired"].empty());
  json fewer = RunOf({1, 1, 1, 1});
  fewer["frames"]["frame"] = {0, 2, 4, 6};
  EXPECT_TRUE(CompareRuns({RunOf({1, 1, 1, 1}), fewer}, {"a", "b"})["paired"].empty());
}

TEST(ReadRun, RefusesOtherFiles) {
  const testing::ScratchFolder folder;
  const auto file = folder / "run.json";
  AtomicWrite(file, RunOf({1, 1, 1, 1}).dump());
  EXPECT_EQ(ReadRun(file)["images"], "rendered");
  AtomicWrite(file, "{\"rows\": []}");
  EXPECT_THROW(ReadRun(file), Error);
  AtomicWrite(file, "no json");
  EXPECT_THROW(ReadRun(file), Error);
  std::filesystem::remove(file);
  EXPECT_THROW(ReadRun(file), Error);
}

}  // namespace
}  // namespace recollect
