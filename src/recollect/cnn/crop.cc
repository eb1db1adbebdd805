#include "recollect/cnn/crop.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "recollect/core/error.h"

namespace recollect::cnn {
namespace {

int Rounded(double value) { return static_cast<int>(std::lround(value)); }

void RequireAspect(const Crop& crop, int width, int height, const std::string& name) {
  const double expected = static_cast<double>(crop.image_width) / crop.image_height;
  const double actual = height > 0 ? static_cast<double>(width) / height : 0;
  Require(width > 0 && std::abs(actual / expected - 1) <= 0.02, name,
          fmt::format("{} x {} pixels, but the network sees images of the aspect {} x {}", width,
                      height, crop.image_width, crop.image_height),
          "use images of the camera that the network was trained with");
}

}  // namespace

Crop Crop::Paper(int image_width, int image_height) {
  Require(image_width > 0 && image_height > 0, "Crop", "the image is empty");
  constexpr int kWidth = 320, kHeight = 240;
  const double aspect = static_cast<double>(image_width) / image_height;
  if (std::abs(aspect * 3 / 4 - 1) < 0.01) return {640, 480, 160, 140, kWidth, kHeight};
  Crop crop{kWidth, kHeight, 0, 0, kWidth, kHeight};
  if (aspect > 4.0 / 3) {
    crop.image_width = Rounded(kHeight * aspect);
    crop.left = (crop.image_width - kWidth) / 2;
  } else {
    crop.image_height = Rounded(kWidth / aspect);
    crop.top = (crop.image_height - kHeight) / 2;
  }
  return crop;
}

Crop Crop::Compact(int image_width, int image_height) {
  Require(image_width > 0 && image_height > 0, "Crop", "the image is empty");
  constexpr double kPixels = 320 * 192, kRows = 0.8;
  constexpr int kMultiple = 16;
  const double aspect = static_cast<double>(image_width) / image_height;
  Require(aspect >= 0.125 && aspect <= 8, "Crop",
          fmt::format("the aspect of {} x {} pixels is beyond 8:1", image_width, image_height));
  Crop crop;
  crop.width = kMultiple * Rounded(std::sqrt(kPixels * aspect / kRows) / kMultiple);
  crop.image_width = crop.width;
  crop.image_height = Rounded(crop.width / aspect);
  crop.height = kMultiple * std::max(1, Rounded(kRows * crop.image_height / kMultiple));
  if (crop.height > crop.image_height) crop.height -= kMultiple;
  crop.top = (crop.image_height - crop.height) / 2;
  return crop;
}

cv::Mat Crop::Apply(const cv::Mat& image, const std::string& name) const {
  Require(image.type() == CV_8UC3 || image.type() == CV_8UC1, name,
          "not an image of 8 bit with one or three channels");
  RequireAspect(*this, image.cols, image.rows, name);
  cv::Mat window = image;
  if (image.cols != image_width || image.rows != image_height) {
    const int how = image.cols > image_width ? cv::INTER_AREA : cv::INTER_LINEAR;
    cv::resize(image, window, {image_width, image_height}, 0, 0, how);
  }
  window = window(cv::Rect(left, top, width, height));
  if (window.channels() == 1) {
    cv::Mat colour;
    cv::cvtColor(window, colour, cv::COLOR_GRAY2BGR);
    return colour;
  }
  return window.clone();
}

PinholeCamera Crop::Apply(const PinholeCamera& camera) const {
  RequireAspect(*this, camera.width, camera.height, "camera");
  return camera.Resized(image_width, image_height).Cropped(left, top, width, height);
}

}  // namespace recollect::cnn
