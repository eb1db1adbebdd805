#include "recollect/wnn/blur.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <vector>

#include "recollect/core/random.h"

namespace recollect::wnn {
namespace {

cv::Mat Noise(int width, int height, int type, std::uint64_t seed) {
  cv::Mat image(height, width, type);
  Random random(seed);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width * image.channels(); ++x) {
      // All black and all white stretches, too: sums reach their limits.
      const auto dice = random.Index(300);
      image.ptr(y)[x] = static_cast<std::uint8_t>(x % 97 < 40 ? (y % 50 < 25 ? 255 : 0) : dice);
    }
  }
  return image;
}

// Whole images, not only far from borders, of all tails, kernels wider than the image among them.
TEST(Blur, IsOpenCvsBitForBitWithEveryKernel) {
  for (const auto& [width, height, size, sigma] : {std::tuple{640, 364, 33, 11.0},
                                                   {97, 41, 5, 1.7},
                                                   {32, 33, 1, 0.5},
                                                   {33, 20, 3, 0.3},
                                                   {9, 8, 33, 11.0},
                                                   {129, 15, 65, 22.0},
                                                   {70, 12, 7, 40.0}}) {
    for (const int type : {CV_8UC1, CV_8UC3}) {
      const cv::Mat image = Noise(width, height, type, static_cast<std::uint64_t>(width));
      cv::Mat expected, blurred(height, width, type);
      cv::GaussianBlur(image, expected, {size, size}, sigma, 0, cv::BORDER_REFLECT_101);
      Blur blur(width, height, size, sigma, 2);
      for (const Kernel* kernel : Kernels()) {
        blurred.setTo(0);
        for (int y = 0; y < height; ++y) blur.Row(*kernel, image, y, y % 2, blurred.ptr(y));
        EXPECT_EQ(cv::norm(blurred, expected, cv::NORM_INF), 0)
            << kernel->name << " " << width << " x " << height << " by " << size;
      }
    }
  }
}

}  // namespace
}  // namespace recollect::wnn
