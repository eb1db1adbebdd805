#include "recollect/matching/features.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "recollect/core/error.h"
#include "recollect/matching/describe.h"
#include "recollect/matching/points.h"

namespace recollect::matching {

cv::Mat ToGray(const cv::Mat& image) {
  Require(image.type() == CV_8UC1 || image.type() == CV_8UC3, "features",
          "an image must have 8 bits a channel, gray or colour");
  if (image.channels() == 1) return image;
  cv::Mat gray;
  cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  return gray;
}

Features FindFeatures(const cv::Mat& gray, const FeatureOptions& options) {
  Require(gray.type() == CV_8UC1 && gray.cols >= 64 && gray.rows >= 64, "features",
          "an image must be gray, 8 bit and at least 64 x 64");
  const double scale = options.resolution;
  cv::Mat small;
  cv::resize(gray, small, {}, scale, scale, cv::INTER_AREA);
  if (options.clahe > 0) cv::createCLAHE(options.clahe, {8, 8})->apply(small, small);
  const ScaleSpace space(small);
  std::vector<ScalePoint> points = FindPoints(space, options.contrast);
  points.resize(std::min(points.size(), static_cast<std::size_t>(options.count)));

  Features features;
  features.descriptors = Describe(space, points);
  const double sx = static_cast<double>(gray.cols) / small.cols;
  const double sy = static_cast<double>(gray.rows) / small.rows;
  for (const ScalePoint& point : points) {
    const double x = ScaleSpace::ToImage(point.octave, static_cast<double>(point.x));
    const double y = ScaleSpace::ToImage(point.octave, static_cast<double>(point.y));
    features.pixels.emplace_back((x + 0.5) * sx - 0.5, (y + 0.5) * sy - 0.5);
    const double diameter =
        2 * ScaleSpace::PixelSize(point.octave) * static_cast<double>(point.sigma);
    features.sizes.push_back(static_cast<float>(diameter * sx));
  }
  return features;
}

}  // namespace recollect::matching
