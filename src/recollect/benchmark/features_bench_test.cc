#include "recollect/benchmark/features_bench.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>

#include "recollect/core/error.h"
#include "recollect/testing/scratch_folder.h"
#include "recollect/testing/street.h"

namespace recollect {
namespace {

TEST(FeaturesBench, WritesEveryFigure) {
  const testing::ScratchFolder folder;
  const Lap lap = testing::DriveStreet(folder.path(), {});
  const int threads = cv::getNumThreads();
  const nlohmann::json figures = RunFeaturesBench(lap, {.images = 3});
  cv::setNumThreads(threads);
  for (const char* step : {"blur", "points", "descriptors", "match"}) {
    EXPECT_GT(figures["ms"][step]["ours"], 0) << step;
    EXPECT_GT(figures["ms"][step]["opencv"], 0) << step;
    EXPECT_GT(figures["ratio"][step], 0) << step;
  }
  for (const char* step : {"blur", "match"}) EXPECT_GT(figures["share_of_peak"][step], 0) << step;
  EXPECT_FALSE(DescribeFeaturesBench(figures).empty());
  EXPECT_THROW(RunFeaturesBench(Lap{}), Error);
}

}  // namespace
}  // namespace recollect
