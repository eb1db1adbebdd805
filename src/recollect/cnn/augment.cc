#include "recollect/cnn/augment.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>

namespace recollect::cnn {
namespace {

// out = (1 - s) gray + s colour, s the saturation, each channel then times its balance and gain.
cv::Matx33f ColourMatrix(double gain, Random& random) {
  const double saturation = random.Uniform(0.0, 1.3);
  constexpr std::array<double, 3> kGray = {0.114, 0.587, 0.299};
  cv::Matx33f matrix;
  for (int row = 0; row < 3; ++row) {
    const double balance = gain * std::exp(0.12 * random.Normal());
    for (int column = 0; column < 3; ++column) {
      const double gray = (1 - saturation) * kGray[static_cast<std::size_t>(column)];
      matrix(row, column) = static_cast<float>(balance * (gray + (row == column) * saturation));
    }
  }
  return matrix;
}

cv::Mat GammaTable(Random& random) {
  const double gamma = std::exp(random.Uniform(-0.5, 0.5));
  const double contrast = random.Uniform(0.5, 1.1), haze = (1 - contrast) * random.Uniform();
  cv::Mat table(1, 256, CV_8U);
  for (int i = 0; i < 256; ++i) {
    table.at<std::uint8_t>(i) =
        cv::saturate_cast<std::uint8_t>(255 * (contrast * std::pow(i / 255.0, gamma) + haze));
  }
  return table;
}

// Multiplies the image by a light that changes evenly across it.
void Slope(cv::Mat& image, Random& random) {
  const double across = random.Uniform(-0.4, 0.4), down = random.Uniform(-0.4, 0.4);
  cv::Mat corners(2, 2, CV_32F);
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 2; ++x) {
      corners.at<float>(y, x) = static_cast<float>(1 + across * (x - 0.5) + down * (y - 0.5));
    }
  }
  cv::Mat light;
  cv::resize(corners, light, image.size(), 0, 0, cv::INTER_LINEAR);
  cv::cvtColor(light, light, cv::COLOR_GRAY2BGR);
  cv::multiply(image, light, image, 1, CV_8U);
}

void AddNoise(cv::Mat& image, double deviation, Random& random) {
  cv::RNG generator(random.Bits());
  cv::Mat noise(image.size(), CV_16SC3);
  generator.fill(noise, cv::RNG::NORMAL, 0, deviation);
  cv::add(image, noise, image, cv::noArray(), CV_8U);
}

}  // namespace

cv::Mat AugmentLight(const cv::Mat& image, Random& random) {
  cv::Mat out;
  const double gain = std::exp(random.Uniform(std::log(0.15), std::log(1.5)));
  cv::transform(image, out, ColourMatrix(gain, random));
  cv::LUT(out, GammaTable(random), out);
  if (random.Uniform() < 0.3) Slope(out, random);
  if (random.Uniform() < 0.3) cv::GaussianBlur(out, out, {}, random.Uniform(0.4, 1.2));
  if (random.Uniform() < 0.3) AddNoise(out, random.Uniform(1, 4), random);
  return out;
}

}  // namespace recollect::cnn
