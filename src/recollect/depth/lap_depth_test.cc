#include "recollect/depth/lap_depth.h"

#include <gtest/gtest.h>
#include <chrono>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "recollect/core/error.h"
#include "recollect/core/files.h"
#include "recollect/dataset/image.h"
#include "recollect/dataset/reader.h"
#include "recollect/depth/evaluate.h"
#include "recollect/depth/test_pairs.h"
#include "recollect/testing/scratch_folder.h"

namespace recollect::stereo {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 240, kHeight = 160;

class LapDepth : public ::testing::Test {
 protected:
  void SetUp() override {
    options_.sgm.disparities = 32;
    options_.sps.superpixels = 40;
    const testing::Pair pair = testing::Surface(kWidth, kHeight, [](int, int) { return 12; });
    for (const char* kind : {"image_2", "image_3"}) fs::create_directories(folder_ / kind);
    std::string poses;
    for (int i = 0; i < 3; ++i) {
      cv::imwrite(Image("image_2", i).string(), pair.left);
      if (i != 1) cv::imwrite(Image("image_3", i).string(), pair.right);
      poses += fmt::format("1 0 0 0 0 1 0 0 0 0 1 {}\n", i);
    }
    AtomicWrite(folder_ / "poses.txt", poses);
    AtomicWrite(folder_ / "calib.txt",
                "P2: 200 0 120 0 0 200 80 0 0 0 1 0\nP3: 200 0 120 -60 0 200 80 0 0 0 1 0\n");
  }

  fs::path Image(const char* kind, int i) const {
    return folder_ / kind / fmt::format("{:06}.png", i);
  }
  LapDepthResult Write(int threads = 2) {
    ThreadPool pool(threads);
    return WriteLapDepth(ReadLap(folder_.path()), folder_ / "depth", options_, pool);
  }
  std::string Failure() {
    try {
      Write();
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  recollect::testing::ScratchFolder folder_;
  MatchOptions options_;
};

TEST_F(LapDepth, MakesDepthForFramesWithARightImage) {
  const LapDepthResult result = Write();
  EXPECT_EQ(result.made, 2);
  EXPECT_EQ(result.without_right, 1);
  EXPECT_TRUE(result.warnings.empty());
  const Lap lap = ReadLap(folder_.path());
  EXPECT_TRUE(lap.frames[1].depth.empty());
  const cv::Mat depth = ReadDepth(lap.frames[2].depth, lap.depth_unit);
  EXPECT_EQ(cv::countNonZero(depth), kWidth * kHeight);
  EXPECT_NEAR(depth.at<float>(40, 100), 60.0 / 12, 0.1);
}

TEST_F(LapDepth, GoesOnWhereItStopped) {
  Write();
  const std::string whole = ReadFile(Image("depth", 0));
  const auto age = fs::last_write_time(Image("depth", 2)) - std::chrono::hours(1);
  fs::last_write_time(Image("depth", 2), age);
  fs::remove(Image("depth", 0));
  AtomicWrite(folder_ / "depth" / ".000000.77.png", "cut short");
  const LapDepthResult result = Write();
  EXPECT_EQ(result.made, 1);
  EXPECT_EQ(result.kept, 1);
  EXPECT_EQ(ReadFile(Image("depth", 0)), whole);
  EXPECT_EQ(fs::last_write_time(Image("depth", 2)), age);
}

TEST_F(LapDepth, GivesTheSameBytesForAnyNumberOfThreads) {
  Write(1);
  const std::string one = ReadFile(Image("depth", 2));
  fs::remove_all(folder_ / "depth");
  Write(3);
  EXPECT_EQ(ReadFile(Image("depth", 2)), one);
}

TEST_F(LapDepth, LeavesDepthAloneThatItDidNotMake) {
  Write();
  options_.sgm.disparities = 48;
  EXPECT_NE(Failure().find("made with other options"), std::string::npos);
  fs::remove(folder_ / "depth" / "depth.txt");
  EXPECT_NE(Failure().find("did not make"), std::string::npos);
}

TEST_F(LapDepth, RefusesALapWithoutRightImages) {
  fs::remove_all(folder_ / "image_3");
  EXPECT_NE(Failure().find("has no right images"), std::string::npos);
}

TEST_F(LapDepth, RefusesRightImagesOfAnotherSizeOrDepth) {
  cv::imwrite(Image("image_3", 2).string(), cv::Mat::zeros(kHeight, kWidth + 2, CV_8U));
  EXPECT_NE(Failure().find("000002.png"), std::string::npos);
  cv::imwrite(Image("image_3", 2).string(), cv::Mat::zeros(kHeight, kWidth, CV_16U));
  EXPECT_NE(Failure().find("16 bits"), std::string::npos);
}

TEST_F(LapDepth, RefusesSwappedImages) {
  fs::rename(folder_ / "image_2", folder_ / "other");
  fs::rename(folder_ / "image_3", folder_ / "image_2");
  fs::rename(folder_ / "other", folder_ / "image_3");
  cv::imwrite(Image("image_2", 1).string(), cv::Mat::zeros(kHeight, kWidth, CV_8U));
  EXPECT_NE(Failure().find("swapped"), std::string::npos);
  EXPECT_FALSE(fs::exists(Image("depth", 0)));
}

TEST_F(LapDepth, EvaluationFindsItsOwnDepthRight) {
  Write();
  ThreadPool pool(2);
  const DepthEvaluation result = EvaluateDepth(ReadLap(folder_.path()), options_, 1, pool);
  EXPECT_EQ(result.frames, 2);
  ASSERT_EQ(result.methods.size(), 3U);
  EXPECT_EQ(result.methods[0].errors.density, 1);
  EXPECT_LT(result.methods[0].errors.bad1, 0.01);
  EXPECT_LT(result.methods[1].errors.density, 1);
  EXPECT_LT(result.methods[2].errors.bad3_visible_valid, 0.05);
}

}  // namespace
}  // namespace recollect::stereo
