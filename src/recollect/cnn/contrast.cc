#include "recollect/cnn/contrast.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace recollect::cnn {
namespace {

// Mean over a neighbourhood, by way of an image of a sixteenth of the size: its cost does not grow
// with the neighbourhood.
cv::Mat LocalMean(const cv::Mat& image) {
  constexpr int kScale = 16;
  const cv::Size coarse(std::max(1, image.cols / kScale), std::max(1, image.rows / kScale));
  cv::Mat mean;
  cv::resize(image, mean, coarse, 0, 0, cv::INTER_AREA);
  cv::blur(mean, mean, {3, 3}, {-1, -1}, cv::BORDER_REPLICATE);
  cv::resize(mean, mean, image.size(), 0, 0, cv::INTER_LINEAR);
  return mean;
}

}  // namespace

void NormaliseContrast(std::span<cv::Mat> planes) {
  constexpr float kFloor = 3;
  cv::Mat deviation = cv::Mat::zeros(planes.front().size(), CV_32F);
  const auto count = static_cast<std::ptrdiff_t>(deviation.total());
  auto* deviations = deviation.ptr<float>();
  for (cv::Mat& plane : planes) {
    const cv::Mat mean = LocalMean(plane);
    auto* values = plane.ptr<float>();
    const auto* means = mean.ptr<float>();
    for (std::ptrdiff_t i = 0; i < count; ++i) {
      values[i] -= means[i];
      deviations[i] += std::abs(values[i]);
    }
  }
  cv::Mat gain = LocalMean(deviation);
  auto* gains = gain.ptr<float>();
  const float share = 1 / static_cast<float>(planes.size());
  for (std::ptrdiff_t i = 0; i < count; ++i) gains[i] = 1 / (share * gains[i] + kFloor);
  for (cv::Mat& plane : planes) {
    auto* values = plane.ptr<float>();
    for (std::ptrdiff_t i = 0; i < count; ++i) values[i] *= gains[i];
  }
}

}  // namespace recollect::cnn
