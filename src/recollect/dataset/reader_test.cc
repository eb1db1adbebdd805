#include "recollect/dataset/reader.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "recollect/core/error.h"
#include "recollect/dataset/image.h"
#include "recollect/dataset/sampling.h"

namespace recollect {
namespace {

TEST(Reader, ReadsLapsWithDepthAndSatelliteFixes) {
  const std::filesystem::path data = RECOLLECT_SHARED_DATA "/torcs-wheel";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << data << " is missing";
  const std::vector<Lap> laps = ReadLaps(data);
  ASSERT_EQ(laps.size(), 4u);
  EXPECT_EQ(laps[3].name, "lap-04");
  EXPECT_EQ(laps[0].frames.size(), 440u);
  EXPECT_EQ(laps[0].camera.left.width, 640);
  EXPECT_NEAR(laps[0].camera.baseline, 0.24, 1e-9);
  EXPECT_FALSE(laps[0].frames[5].right.empty());
  EXPECT_TRUE(laps[0].frames[6].right.empty());
  EXPECT_EQ(laps[0].gps.size(), 418u);
  const cv::Mat depth = ReadDepth(laps[0].frames[7].depth, laps[0].depth_unit);
  EXPECT_EQ(DepthCamera(laps[0].camera.left, depth.cols, depth.rows).fx,
            laps[0].camera.left.fx / 2);
  EXPECT_EQ(ReadColour(laps[0].frames[7].left).size(), cv::Size(640, 480));
  EXPECT_EQ(SampleFrames(laps[0], 5).size(), 80u);
}

}  // namespace
}  // namespace recollect
