#include "recollect/depth/disparity.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string_view>
#include <vector>

#include "recollect/core/files.h"

namespace recollect::stereo {
namespace {

constexpr double kDepthStep = 0.01;  // metres, of laps' depth images

// Fills the gaps of a line of `count` values that lie `stride` apart.
void FillLine(float* line, int count, std::ptrdiff_t stride) {
  const auto at = [&](int i) -> float& { return line[i * stride]; };
  for (int i = 0; i < count; ++i) {
    if (at(i) >= 0) continue;
    int end = i;
    while (end < count && at(end) < 0) ++end;
    const bool before = i > 0, after = end < count;
    if (!before && !after) return;
    const float value = before && after ? std::min(at(i - 1), at(end)) : at(before ? i - 1 : end);
    for (; i < end; ++i) at(i) = value;
  }
}

}  // namespace

cv::Mat FillFromBackground(const cv::Mat& disparity) {
  cv::Mat filled = disparity.clone();
  for (int y = 0; y < filled.rows; ++y) FillLine(filled.ptr<float>(y), filled.cols, 1);
  for (int x = 0; x < filled.cols; ++x) {
    FillLine(filled.ptr<float>(0) + x, filled.rows, static_cast<std::ptrdiff_t>(filled.step1()));
  }
  return filled;
}

cv::Mat DepthFromDisparity(const cv::Mat& disparity, const StereoCamera& camera) {
  cv::Mat depth(disparity.size(), CV_32F);
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      const float d = disparity.at<float>(y, x);
      float& z = depth.at<float>(y, x);
      if (d < 0) {
        z = 0;
      } else if (d == 0) {
        z = std::numeric_limits<float>::infinity();
      } else {
        z = static_cast<float>(camera.Depth(d));
      }
    }
  }
  return depth;
}

void WriteDepth(const std::filesystem::path& path, const cv::Mat& depth) {
  cv::Mat steps(depth.size(), CV_16U);
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      const double value = depth.at<float>(y, x) / kDepthStep;
      steps.at<std::uint16_t>(y, x) =
          value > 0 ? static_cast<std::uint16_t>(std::lround(std::clamp(value, 1.0, 65535.0))) : 0;
    }
  }
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", steps, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1});
  AtomicWrite(path, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

cv::Mat ColourDisparity(const cv::Mat& disparity, double greatest) {
  cv::Mat scaled, colour;
  disparity.convertTo(scaled, CV_8U, 255 / greatest);
  cv::applyColorMap(scaled, colour, cv::COLORMAP_TURBO);
  colour.setTo(cv::Scalar(0, 0, 0), disparity < 0);
  return colour;
}

double GreatestDisparity(const cv::Mat& disparity) {
  std::vector<float> known;
  for (int y = 0; y < disparity.rows; ++y) {
    std::copy_if(disparity.ptr<float>(y), disparity.ptr<float>(y) + disparity.cols,
                 std::back_inserter(known), [](float d) { return d >= 0; });
  }
  if (known.empty()) return 1;
  const auto rank = known.begin() + static_cast<std::ptrdiff_t>(known.size() * 98 / 100);
  std::nth_element(known.begin(), rank, known.end());
  return std::max(1.0, static_cast<double>(*rank));
}

}  // namespace recollect::stereo
