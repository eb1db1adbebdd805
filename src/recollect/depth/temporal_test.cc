#include "recollect/depth/temporal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>

namespace recollect::stereo {
namespace {

TEST(Temporal, DepthMovedByTheTruePoseAgreesAndByAnotherDoesNot) {
  const PinholeCamera camera{60, 40, 50, 50, 30, 20};
  const cv::Mat wall(40, 60, CV_32F, cv::Scalar(10)), nearer(40, 60, CV_32F, cv::Scalar(8));
  const SE3 ahead(Eigen::Matrix3d::Identity(), {0, 0, -2});  // two metres forward
  const auto errors = MovedDepthErrors(wall, nearer, ahead, camera);
  ASSERT_GT(errors.size(), 1000U);
  EXPECT_LT(*std::max_element(errors.begin(), errors.end()), 1e-6);
  EXPECT_NEAR(MovedDepthErrors(wall, nearer, SE3(), camera).front(), 0.25, 1e-6);
  EXPECT_TRUE(MovedDepthErrors(cv::Mat::zeros(40, 60, CV_32F), nearer, ahead, camera).empty());
}

}  // namespace
}  // namespace recollect::stereo
