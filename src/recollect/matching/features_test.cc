#include "recollect/matching/features.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "recollect/core/error.h"
#include "recollect/matching/describe.h"
#include "recollect/matching/match.h"
#include "recollect/matching/test_images.h"

namespace recollect::matching {
namespace {

double Cosine(const std::int8_t* a, const std::int8_t* b) {
  return Likeness(a, b) / std::sqrt(static_cast<double>(Likeness(a, a)) * Likeness(b, b));
}

TEST(Describe, IsMuchLikeUprightRootSift) {
  const cv::Mat image = Blobs(320, 240, 5);
  const ScaleSpace space(image);
  const std::vector<ScalePoint> points = FindPoints(space, 0.01);
  ASSERT_GT(points.size(), 100u);
  const auto ours = Describe(space, points);
  // The same points as OpenCV numbers octaves, the doubled image being -1.
  std::vector<cv::KeyPoint> upright;
  for (const ScalePoint& p : points) {
    const auto pixel = static_cast<float>(ScaleSpace::PixelSize(p.octave));
    upright.emplace_back(pixel * p.x, pixel * p.y, 2 * pixel * p.sigma, 0.0f, p.contrast,
                         ((p.octave - 1) & 255) | (p.layer << 8));
  }
  cv::Mat theirs;
  cv::SIFT::create()->compute(image, upright, theirs);
  ASSERT_EQ(ours.size(), static_cast<std::size_t>(theirs.rows * kDescriptorBytes));
  std::vector<double> cosines;
  for (int i = 0; i < theirs.rows; ++i) {
    std::int8_t root[kDescriptorBytes];
    const float* sift = theirs.ptr<float>(i);
    float sum = 0;
    for (int k = 0; k < kDescriptorBytes; ++k) sum += sift[k];
    for (int k = 0; k < kDescriptorBytes; ++k) {
      root[k] = static_cast<std::int8_t>(std::min(127.0f, 320 * std::sqrt(sift[k] / sum) + 0.5f));
    }
    cosines.push_back(Cosine(root, ours.data() + i * kDescriptorBytes));
  }
  std::sort(cosines.begin(), cosines.end());
  EXPECT_GT(cosines[cosines.size() / 2], 0.985);
  EXPECT_GT(cosines[cosines.size() / 20], 0.95);
}

TEST(Describe, IsTheSameWhateverTheThreads) {
  const ScaleSpace space(Blobs(320, 240, 6));
  const std::vector<ScalePoint> points = FindPoints(space, 0.01);
  const auto many = Describe(space, points);
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  const auto one = Describe(space, points);
  cv::setNumThreads(threads);
  EXPECT_EQ(one, many);
}

TEST(FindFeatures, FindsAMovedAndDarkenedImageAgain) {
  const cv::Mat image = Blobs(640, 480, 7);
  cv::Mat moved;
  const cv::Mat by = (cv::Mat_<double>(2, 3) << 1.05, 0, 7.5, 0, 1.05, -4.25);
  cv::warpAffine(image, moved, by, image.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT);
  moved = moved * 0.6 + 10;
  const Features a = FindFeatures(image), b = FindFeatures(moved);
  ASSERT_GT(a.size(), 300);
  const auto matches =
      MatchDescriptors(b.descriptors.data(), b.size(), a.descriptors.data(), a.size());
  int right = 0;
  for (const Match& m : matches) {
    const Eigen::Vector2d& from = a.pixels[static_cast<std::size_t>(m.mapped)];
    const Eigen::Vector2d expected(1.05 * from.x() + 7.5, 1.05 * from.y() - 4.25);
    right += (b.pixels[static_cast<std::size_t>(m.live)] - expected).norm() < 2 ? 1 : 0;
  }
  EXPECT_GT(right, a.size() / 3);
  EXPECT_GT(right, static_cast<int>(matches.size()) * 9 / 10);
}

TEST(FindFeatures, OfAnEvenImageAreNone) {
  EXPECT_EQ(FindFeatures(cv::Mat(240, 320, CV_8UC1, cv::Scalar(90))).size(), 0);
}

TEST(FindFeatures, RefusesWhatIsNoGrayImage) {
  EXPECT_THROW(FindFeatures(cv::Mat(240, 320, CV_8UC3)), Error);
  EXPECT_THROW(FindFeatures(cv::Mat(8, 8, CV_8UC1)), Error);
  EXPECT_THROW(ToGray(cv::Mat(240, 320, CV_16UC1)), Error);
}

}  // namespace
}  // namespace recollect::matching
