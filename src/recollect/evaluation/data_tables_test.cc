#include "recollect/evaluation/data_tables.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "recollect/core/error.h"

namespace recollect {
namespace {

TEST(DataTables, AreThoseOfThePaper) {
  const std::filesystem::path data = RECOLLECT_SHARED_DATA "/ufes-laps";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << data << " is missing";
  const nlohmann::json tables = ToJson(ComputeDataTables(data));

  const std::vector<std::array<int, 3>> expected = {
      {7066, 2867, 681}, {6886, 2725, 678}, {6305, 2662, 679}, {1808, 725, 170},
      {9308, 2855, 669}, {1869, 704, 171},  {7876, 2832, 665}, {17819, 6012, 1398},
      {7996, 2868, 669}, {7605, 2899, 662}};
  ASSERT_EQ(tables["laps"].size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(tables["laps"][i]["rows"], expected[i][0]) << tables["laps"][i];
    EXPECT_EQ(tables["laps"][i]["at_1m"], expected[i][1]) << tables["laps"][i];
    EXPECT_EQ(tables["laps"][i]["at_5m"], expected[i][2]) << tables["laps"][i];
  }
  EXPECT_EQ(tables["laps"][6]["name"], "20171122");
  EXPECT_EQ(tables["laps"][6]["lap"], "07");
  EXPECT_EQ(tables["registration"], R"({"classes": 636, "train": 4429, "test": 2784})"_json);
  EXPECT_EQ(tables["pairs"], R"({"train": 98425, "valid": 3471, "test": 14249})"_json);
  EXPECT_NEAR(tables["gps"]["available"], 0.8965, 5e-5);
  EXPECT_NEAR(tables["gps"]["mean_m"], 0.2335, 5e-4);
  EXPECT_NEAR(tables["gps"]["median_m"], 0.184, 5e-4);
  EXPECT_NEAR(tables["gps"]["p75_m"], 0.295, 5e-4);
  EXPECT_NEAR(tables["baselines"]["nearest_all_mean_m"], 0.508, 5e-4);
  EXPECT_NEAR(tables["baselines"]["nearest_one_lap_mean_m"], 1.426, 5e-4);
  EXPECT_NEAR(tables["baselines"]["no_motion_mean_m"], 2.06, 5e-3);
}

TEST(DataTables, NeedAFolderOfUfesLaps) { EXPECT_THROW(ComputeDataTables("/nonexistent"), Error); }

}  // namespace
}  // namespace recollect
