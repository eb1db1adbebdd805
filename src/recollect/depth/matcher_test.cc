#include "recollect/depth/matcher.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <opencv2/core.hpp>

#include "recollect/core/error.h"
#include "recollect/dataset/image.h"
#include "recollect/depth/disparity.h"
#include "recollect/depth/evaluate.h"
#include "recollect/depth/test_pairs.h"
#include "recollect/testing/scratch_folder.h"

namespace recollect::stereo {
namespace {

TEST(Matcher, EachMethodFindsAPlaneAndSpsIsDense) {
  const testing::Pair pair = testing::Surface(160, 80, [](int, int) { return 12; });
  ThreadPool pool(2);
  for (const Method method : {Method::kSps, Method::kSgm, Method::kSgbm}) {
    EXPECT_EQ(ParseMethod(MethodName(method)), method);
    MatchOptions options;
    options.method = method;
    options.sgm.disparities = 32;
    options.sps.superpixels = 60;
    const cv::Mat disparity = Matcher(options, pool).Disparity(pair.left, pair.right);
    EXPECT_GT(testing::Right(disparity, pair.disparity, 1, {40, 8, 112, 64}), 0.95)
        << MethodName(method);
    const int known = cv::countNonZero(disparity >= 0);
    EXPECT_EQ(known == 160 * 80, method == Method::kSps) << MethodName(method);
  }
  EXPECT_THROW(ParseMethod("bm"), Error);
}

TEST(Matcher, NamesWhatIsWrongWithAPair) {
  const cv::Mat image(40, 60, CV_8U, cv::Scalar(0)), wide(40, 62, CV_8U, cv::Scalar(0)),
      deep(40, 60, CV_16U, cv::Scalar(0));
  const auto message = [](const cv::Mat& left, const cv::Mat& right) {
    try {
      RequirePair(left, right, "right.png");
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(message(image, image), "");
  EXPECT_NE(message(image, wide).find("right.png: left image is 60 x 40 pixels, right image 62 x"),
            std::string::npos);
  EXPECT_NE(message(image, deep).find("16 bits"), std::string::npos);
  EXPECT_EQ(message(image, wide).find('\n'), std::string::npos);
}

TEST(Disparity, HolesTakeTheFartherOfTheirSides) {
  const float u = kUnknown;
  const cv::Mat given = (cv::Mat_<float>(3, 5) << u, 9, u, u, 4, u, u, u, u, u, 7, u, 2, 3, u);
  const cv::Mat filled = (cv::Mat_<float>(3, 5) << 9, 9, 4, 4, 4, 7, 2, 2, 3, 3, 7, 2, 2, 3, 3);
  EXPECT_EQ(cv::countNonZero(FillFromBackground(given) != filled), 0) << FillFromBackground(given);
}

TEST(Disparity, DepthSurvivesTheFile) {
  const StereoCamera camera{{100, 80, 489.44, 489.44, 50, 40}, 0.24};
  const cv::Mat disparity = (cv::Mat_<float>(1, 5) << kUnknown, 0, 0.1F, 11.75F, 117.4656F);
  const cv::Mat depth = DepthFromDisparity(disparity, camera);
  EXPECT_EQ(depth.at<float>(0, 1), std::numeric_limits<float>::infinity());
  const recollect::testing::ScratchFolder folder;
  const auto path = folder / "depth.png";
  WriteDepth(path, depth);
  const ImageInfo info = ReadImageInfo(path);
  EXPECT_EQ(info.bits, 16);
  EXPECT_EQ(info.channels, 1);
  const cv::Mat back = ReadDepth(path);
  const float expected[] = {0, 655.35F, 655.35F, 10.00F, 1.00F};
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(back.at<float>(0, i), expected[i], 0.006) << i;
}

TEST(Disparity, TruthTellsWhatTheRightCameraSees) {
  // A box of disparity 20 at columns 40 to 59 before a wall of 10, at every second pixel.
  cv::Mat truth(1, 50, CV_32F, cv::Scalar(10));
  truth.colRange(20, 30) = 20;
  const cv::Mat seen = SeenByRight(truth, 2, 100);
  for (int i = 0; i < 50; ++i) {
    const int u = 2 * i;
    if (u == 30 || u == 48 || u == 40) continue;  // the edges themselves
    const bool hidden = u < 10 || (u > 30 && u < 40);
    EXPECT_EQ(seen.at<uchar>(0, i) == 0, hidden) << u;
  }
}

}  // namespace
}  // namespace recollect::stereo
