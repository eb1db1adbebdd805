#include "recollect/evaluation/explanation.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "recollect/core/error.h"
#include "recollect/testing/scratch_folder.h"

namespace recollect {
namespace {

wnn::Explanation LeftAgainstRight() {
  wnn::Explanation why;
  why.columns = 4;
  why.rows = 2;
  why.winner = {7, 6, {4, 4, 0, 0, 3, 1, 0, 0}};
  why.runner_up = {30, 2, {0, 0, 0, 4, 0, 0, 0, 0}};
  return why;
}

TEST(Explanation, AsJsonHasADigitANeuron) {
  const nlohmann::json json = ToJson(LeftAgainstRight());
  EXPECT_EQ(json.at("columns"), 4);
  EXPECT_EQ(json.at("winner").at("key_frame"), 7);
  EXPECT_EQ(json.at("winner").at("neurons"), (std::vector<std::string>{"4400", "3100"}));
  EXPECT_EQ(json.at("runner_up").at("votes"), 2);
  wnn::Explanation alone = LeftAgainstRight();
  alone.runner_up = {};
  EXPECT_TRUE(ToJson(alone).at("runner_up").is_null());
}

TEST(Explanation, ThePictureIsLitWhereNeuronsVoted) {
  const cv::Mat white(120, 160, CV_8UC3, cv::Scalar::all(255));
  const cv::Mat picture =
      DrawExplanation({white, "live"}, {white, "recollected"}, {}, LeftAgainstRight(), 364.0 / 640);
  ASSERT_EQ(picture.cols, 3 * 480);
  ASSERT_EQ(picture.rows, 2 * (360 + 28));
  // In the lower row, at a share of the middle panel and of the window of 480 x 273.
  const auto at = [&](int panel, double x, double y) {
    return picture.at<cv::Vec3b>(360 + 2 * 28 + static_cast<int>(273 * y),
                                 480 * panel + static_cast<int>(480 * x));
  };
  EXPECT_GT(at(1, 0.12, 0.25)[1], 200);  // votes of both looks
  EXPECT_LT(at(1, 0.87, 0.25)[1], 100);  // none
  EXPECT_GT(at(1, 0.12, 0.75)[1], at(1, 0.37, 0.75)[1]);
  EXPECT_GT(at(2, 0.87, 0.25)[2], 200);
  EXPECT_LT(at(2, 0.12, 0.25)[2], 100);
  EXPECT_EQ(at(0, 0.12, 0.25), cv::Vec3b(80, 220, 80));
  EXPECT_THROW(DrawExplanation({}, {}, {}, LeftAgainstRight(), 0.5), Error);
}

TEST(Explanation, IsWrittenAsItsEndingSays) {
  const testing::ScratchFolder folder;
  const auto file = folder / "explanation.png";
  WriteExplanation(file, cv::Mat(4, 6, CV_8UC3, cv::Scalar(1, 2, 3)));
  const cv::Mat read = cv::imread(file.string());
  EXPECT_EQ(read.size(), cv::Size(6, 4));
  EXPECT_EQ(read.at<cv::Vec3b>(0, 0), cv::Vec3b(1, 2, 3));
}

}  // namespace
}  // namespace recollect
