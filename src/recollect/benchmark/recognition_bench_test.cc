#include "recollect/benchmark/recognition_bench.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "recollect/core/error.h"
#include "recollect/testing/scratch_folder.h"
#include "recollect/testing/street.h"

namespace recollect {
namespace {

TEST(RecognitionBench, WritesEveryFigure) {
  const testing::ScratchFolder folder;
  const Lap lap = testing::DriveStreet(folder.path(), {});
  const PlaceImages places = ReadPlaces({lap}, 5);
  const nlohmann::json figures = RunRecognitionBench(places, lap, {.images = 2, .threads = 2});
  EXPECT_EQ(figures["key_frames"], places.images.size());
  for (const char* name : {"vibgl", "recollect"}) {
    EXPECT_GT(figures[name]["encode_ms"], 0) << name;
    EXPECT_GT(figures[name]["total_ms"], 0) << name;
  }
  EXPECT_EQ(figures["vibgl"]["map_bytes"], 82944);
  EXPECT_NEAR(figures["ratio"]["map"].get<double>(), 1.0 / 9, 1e-9);
  EXPECT_GT(figures["ratio"]["time"], 0);
  EXPECT_NE(DescribeRecognitionBench(figures).find("recollect"), std::string::npos);
  EXPECT_THROW(RunRecognitionBench(places, Lap{}), Error);
}

}  // namespace
}  // namespace recollect
