#include "recollect/wnn/blur.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace recollect::wnn {
namespace {

// The weights that OpenCV takes, in 256ths: what it makes of a lone bright pixel.
std::vector<std::uint16_t> WeightsOf(int size, double sigma) {
  const int radius = size / 2;
  cv::Mat dot = cv::Mat::zeros(1, 4 * radius + 1, CV_8UC1), blurred;
  dot.at<std::uint8_t>(0, 2 * radius) = 255;
  cv::GaussianBlur(dot, blurred, {size, 1}, sigma, 0, cv::BORDER_REFLECT_101);
  std::vector<std::uint16_t> weights(static_cast<std::size_t>(size));
  int others = 0;
  for (int i = 0; i < size; ++i) {
    const std::uint8_t weight = blurred.at<std::uint8_t>(0, radius + i);
    weights[static_cast<std::size_t>(i)] = weight;
    if (i != radius) others += weight;
  }
  weights[static_cast<std::size_t>(radius)] =
      static_cast<std::uint16_t>(256 - others);  // 255 of 256 may round down
  return weights;
}

}  // namespace

Blur::Blur(int width, int height, int size, double sigma, int strips)
    : width_(width),
      height_(height),
      weights_(WeightsOf(size, sigma)),
      scratch_(static_cast<std::size_t>(strips)) {
  const int radius = size / 2;
  for (int i = 0; i < 2 * radius; ++i) {
    const int column = i < radius ? i - radius : width + i - radius;
    border_.push_back(cv::borderInterpolate(column, width, cv::BORDER_REFLECT_101));
  }
  for (Scratch& scratch : scratch_) {
    scratch.rows.resize(weights_.size());
    scratch.sums.resize(static_cast<std::size_t>(width + 2 * radius) * 3);
  }
}

void Blur::Row(const Kernel& kernel, const cv::Mat& image, int y, int strip, std::uint8_t* out) {
  Scratch& scratch = scratch_[static_cast<std::size_t>(strip)];
  const int taps = static_cast<int>(weights_.size());
  for (int tap = 0; tap < taps; ++tap) {
    const int row = cv::borderInterpolate(y + tap - taps / 2, height_, cv::BORDER_REFLECT_101);
    scratch.rows[static_cast<std::size_t>(tap)] = image.ptr(row);
  }
  const int channels = image.channels(), radius = taps / 2;
  const auto pixel = [&](int x) {
    return scratch.sums.begin() + std::ptrdiff_t{x + radius} * channels;
  };
  const BlurTaps blur{weights_.data(), taps};
  kernel.blur_columns(blur, scratch.rows.data(), width_ * channels, &*pixel(0));
  for (int i = 0; i < 2 * radius; ++i) {
    const int beside = i < radius ? i - radius : width_ + i - radius;
    std::copy_n(pixel(border_[static_cast<std::size_t>(i)]), channels, pixel(beside));
  }
  kernel.blur_row(blur, scratch.sums.data(), channels, width_ * channels, out);
}

}  // namespace recollect::wnn
