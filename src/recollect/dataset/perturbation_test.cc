#include "recollect/dataset/perturbation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "recollect/core/error.h"

namespace recollect {
namespace {

cv::Mat Board() {
  cv::Mat image(60, 80, CV_8UC3);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      image.at<cv::Vec3b>(y, x) = cv::Vec3b::all((x / 10 + y / 10) % 2 ? 180 : 60);
    }
  }
  return image;
}

double Distance(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b) / std::sqrt(a.total());
}

TEST(Perturbation, OfNothingChangesNothing) {
  const Perturbation none{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_LT(Distance(Perturbed(Board(), 3, none), Board()), 1);
}

TEST(Perturbation, IsAFunctionOfItsSeed) {
  EXPECT_EQ(Distance(Perturbed(Board(), 3), Perturbed(Board(), 3)), 0);
  EXPECT_GT(Distance(Perturbed(Board(), 3), Perturbed(Board(), 4)), 10);
  EXPECT_THROW(Perturbed(cv::Mat(4, 4, CV_8UC1), 1), Error);
}

TEST(Perturbation, ChangesSlowlyAlongAWay) {
  double near = 0, far = 0;
  for (int place = 0; place < 40; ++place) {
    const Visit here = VisitAlong(7, place, 10);
    for (std::size_t i = 0; i < here.at.size(); ++i) {
      EXPECT_GE(here.at[i], 0);
      EXPECT_LE(here.at[i], 1);
      near += std::abs(here.at[i] - VisitAlong(7, place + 1, 10).at[i]);
      far += std::abs(here.at[i] - VisitAlong(7, place + 20, 10).at[i]);
    }
  }
  EXPECT_LT(near, far / 4);
  EXPECT_GT(near, 0);
}

}  // namespace
}  // namespace recollect
