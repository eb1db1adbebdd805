#include "recollect/depth/sps.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "recollect/core/error.h"

namespace recollect::stereo {
namespace {

cv::Mat Lab(const cv::Mat& image) {
  cv::Mat colour = image, lab;
  if (image.channels() == 1) cv::cvtColor(image, colour, cv::COLOR_GRAY2BGR);
  cv::cvtColor(colour, lab, cv::COLOR_BGR2Lab);
  return lab;
}

}  // namespace

void CheckOptions(const SpsOptions& options) {
  Require(options.superpixels >= 1, "superpixels", "must be at least 1");
  Require(options.outer_rounds >= 1 && options.inner_rounds >= 1, "rounds", "must be at least 1");
  Require(options.planes.inlier_px > 0 && options.planes.start_inlier_px > 0, "inlier threshold",
          "must be positive");
}

SlantedPlaneResult SmoothBySlantedPlanes(const cv::Mat& left, const cv::Mat& disparity,
                                         const SpsOptions& options) {
  CheckOptions(options);
  Require((left.type() == CV_8UC1 || left.type() == CV_8UC3) && disparity.type() == CV_32FC1 &&
              left.size() == disparity.size() && !left.empty(),
          "slanted planes", "want an 8-bit image and 32-bit disparities of its size");
  Require(cv::countNonZero(disparity >= 0) > 0, "slanted planes", "not a single disparity is known",
          "are these two images of one scene?");
  const cv::Mat lab = Lab(left);
  Superpixels superpixels(lab, disparity, options.superpixels, options.segments);
  SlantedPlanes planes(options.planes);
  superpixels.Move({}, 2);
  planes.Begin(superpixels.Labels(), disparity, superpixels.count());
  for (int round = 0; round < options.outer_rounds; ++round) {
    superpixels.Move(planes.planes(), 2);
    planes.Refine(superpixels.Labels(), disparity, options.inner_rounds);
  }
  SlantedPlaneResult result{cv::Mat(left.size(), CV_32F), cv::Mat(left.size(), CV_8U),
                            superpixels.Labels(), planes.planes(), planes.Boundaries()};
  for (int y = 0; y < left.rows; ++y) {
    for (int x = 0; x < left.cols; ++x) {
      const auto label = static_cast<std::size_t>(result.labels.at<std::int32_t>(y, x));
      const float given = disparity.at<float>(y, x);
      const auto smooth = static_cast<float>(std::max(0.0, result.planes[label].At(x, y)));
      result.disparity.at<float>(y, x) = smooth;
      const bool agrees =
          given >= 0 && std::abs(given - smooth) < static_cast<float>(options.planes.inlier_px);
      result.measured.at<std::uint8_t>(y, x) = agrees ? 255 : 0;
    }
  }
  return result;
}

}  // namespace recollect::stereo
