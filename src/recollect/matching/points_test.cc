#include "recollect/matching/points.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "recollect/core/error.h"
#include "recollect/core/random.h"
#include "recollect/matching/test_images.h"

namespace recollect::matching {
namespace {

constexpr double kContrast = 0.01;

// A point as OpenCV has it, in the image's pixels.
cv::KeyPoint InImage(const ScalePoint& point) {
  return {static_cast<float>(ScaleSpace::ToImage(point.octave, static_cast<double>(point.x))),
          static_cast<float>(ScaleSpace::ToImage(point.octave, static_cast<double>(point.y))),
          static_cast<float>(2 * ScaleSpace::PixelSize(point.octave)) * point.sigma};
}

// Share of `some` that are among `others`.
double Found(const std::vector<cv::KeyPoint>& some, const std::vector<cv::KeyPoint>& others) {
  int found = 0;
  for (const cv::KeyPoint& a : some) {
    for (const cv::KeyPoint& b : others) {
      if (std::hypot(a.pt.x - b.pt.x, a.pt.y - b.pt.y) < 0.15 * std::max(1.0f, a.size / 4) &&
          std::abs(a.size / b.size - 1) < 0.1f) {
        ++found;
        break;
      }
    }
  }
  return found / static_cast<double>(some.size());
}

TEST(FindPoints, FindsWhatOpenCvFinds) {
  const cv::Mat image = Blobs(331, 242, 5);
  std::vector<cv::KeyPoint> theirs, ours;
  cv::SIFT::create(0, kLayers, kContrast, 10, kBaseSigma)->detect(image, theirs);
  // It doubles the image about its middle, and halves the coordinates about the first pixel.
  for (cv::KeyPoint& point : theirs) point.pt -= cv::Point2f(0.25f, 0.25f);
  for (const ScalePoint& point : FindPoints(ScaleSpace(image), kContrast)) {
    ours.push_back(InImage(point));
  }
  ASSERT_GT(ours.size(), 200u);
  EXPECT_GT(Found(ours, theirs), 0.95);
  EXPECT_GT(Found(theirs, ours), 0.93);
}

TEST(FindPoints, FindsABlobBetweenThePixels) {
  cv::Mat image(120, 160, CV_8UC1);
  const double x = 70.3, y = 51.6, sigma = 5;
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      const double square = (u - x) * (u - x) + (v - y) * (v - y);
      image.at<std::uint8_t>(v, u) =
          cv::saturate_cast<std::uint8_t>(60 + 150 * std::exp(-square / (2 * sigma * sigma)));
    }
  }
  const auto points = FindPoints(ScaleSpace(image), kContrast);
  ASSERT_FALSE(points.empty());
  const cv::KeyPoint found = InImage(points.front());
  EXPECT_NEAR(found.pt.x, x, 0.05);
  EXPECT_NEAR(found.pt.y, y, 0.05);
  EXPECT_NEAR(found.size, 2 * sigma, 0.15 * 2 * sigma);
}

TEST(FindPoints, AreTheSameWhateverTheThreads) {
  const cv::Mat image = Blobs(320, 240, 6);
  const auto many = FindPoints(ScaleSpace(image), kContrast);
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  const auto one = FindPoints(ScaleSpace(image), kContrast);
  cv::setNumThreads(threads);
  ASSERT_EQ(one.size(), many.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].x, many[i].x);
    EXPECT_EQ(one[i].contrast, many[i].contrast);
    EXPECT_LE(one[i].contrast, one[i == 0 ? 0 : i - 1].contrast);
  }
}

TEST(FindPoints, LeavesEdgesOut) {
  cv::Mat image(120, 160, CV_8UC1, cv::Scalar(40));
  image.colRange(80, 160) = 200;
  EXPECT_TRUE(FindPoints(ScaleSpace(image), kContrast).empty());
}

TEST(Blur, IsTheGaussianOfOpenCv) {
  Random random(3);
  for (const cv::Size size : {cv::Size(97, 40), cv::Size(16, 30), cv::Size(64, 131)}) {
    cv::Mat image(size, CV_32FC1), ours, theirs;
    for (float& value : cv::Mat_<float>(image)) value = static_cast<float>(random.Uniform(0, 255));
    for (const double sigma : {0.8, 1.6, 3.1}) {
      Blur(image, ours, sigma);
      const int side = 2 * static_cast<int>(std::ceil(3 * sigma)) + 1;
      cv::GaussianBlur(image, theirs, {side, side}, sigma, sigma, cv::BORDER_REFLECT_101);
      EXPECT_LT(cv::norm(ours, theirs, cv::NORM_INF), 1e-3) << size << sigma;
    }
  }
}

TEST(Blur, RefusesWhatIsTooSmall) {
  cv::Mat out;
  EXPECT_THROW(Blur(cv::Mat(40, 15, CV_32FC1, cv::Scalar(0)), out, 1), Error);
  EXPECT_THROW(Blur(cv::Mat(6, 40, CV_32FC1, cv::Scalar(0)), out, 3), Error);
  EXPECT_THROW(Blur(cv::Mat(40, 40, CV_8UC1, cv::Scalar(0)), out, 1), Error);
}

}  // namespace
}  // namespace recollect::matching
