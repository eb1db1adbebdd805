#include "recollect/depth/pair_check.h"

#include <gtest/gtest.h>

#include <string>

#include "recollect/core/error.h"
#include "recollect/depth/test_pairs.h"

namespace recollect::stereo {
namespace {

const testing::Pair kPair =
    testing::Surface(320, 200, [](int x, int y) { return 6 + 0.02 * x + 0.03 * y; });

TEST(PairCheck, SaysNothingAboutAGoodPair) {
  const PairCheck check = CheckPair(kPair.left, kPair.right);
  EXPECT_GT(check.matches, 50);
  EXPECT_LT(check.vertical_px, 0.5);
  EXPECT_LT(check.reversed, 0.2);
  EXPECT_NO_THROW(RequireLeftIsLeft(check, "pair"));
  EXPECT_EQ(RectificationWarning(check, "pair"), "");
}

TEST(PairCheck, TellsThatAPairIsSwapped) {
  const PairCheck check = CheckPair(kPair.right, kPair.left);
  try {
    RequireLeftIsLeft(check, "left.png");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("left.png: left and right images are swapped"),
              std::string::npos)
        << error.what();
  }
}

TEST(PairCheck, WarnsOfRowsThatDoNotMatch) {
  const cv::Rect upper(0, 0, 320, 196), lower(0, 4, 320, 196);
  const PairCheck check = CheckPair(kPair.left(upper).clone(), kPair.right(lower).clone());
  EXPECT_NEAR(check.vertical_px, 4, 0.5);
  EXPECT_NE(RectificationWarning(check, "pair").find("not rectified"), std::string::npos);
}

TEST(PairCheck, JudgesNothingWithoutTexture) {
  const cv::Mat gray(100, 100, CV_8U, cv::Scalar(90));
  const PairCheck check = CheckPair(gray, gray);
  EXPECT_NO_THROW(RequireLeftIsLeft(check, "pair"));
  EXPECT_EQ(RectificationWarning(check, "pair"), "");
}

}  // namespace
}  // namespace recollect::stereo
