#include "recollect/cnn/contrast.h"

#include <algorithm>
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

cv::Mat NormaliseContrast(const cv::Mat& image) {
  constexpr double kFloor = 3;
  cv::Mat centred;
  image.convertTo(centred, CV_32F);
  centred -= LocalMean(centred);
  cv::Mat deviation;
  cv::transform(cv::abs(centred), deviation, cv::Matx13f(1.F / 3, 1.F / 3, 1.F / 3));
  cv::Mat gain = 1.0 / (LocalMean(deviation) + kFloor);
  cv::cvtColor(gain, gain, cv::COLOR_GRAY2BGR);
  return centred.mul(gain);
}

}  // namespace recollect::cnn
