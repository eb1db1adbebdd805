#include "recollect/matching/features.h"

#include <algorithm>
#include <cmath>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <tuple>

#include "recollect/core/error.h"
#include "recollect/matching/describe.h"

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
  const auto sift = cv::SIFT::create(0, kLayers, options.contrast, 10, kBaseSigma);
  std::vector<cv::KeyPoint> points;
  sift->detect(small, points);
  // One of the copies that SIFT makes of a point with several orientations; here it has none.
  const auto order = [](const cv::KeyPoint& p) {
    return std::tuple(-p.response, p.pt.x, p.pt.y, p.size);
  };
  std::sort(points.begin(), points.end(),
            [&](const cv::KeyPoint& a, const cv::KeyPoint& b) { return order(a) < order(b); });
  points.erase(std::unique(points.begin(), points.end(),
                           [](const cv::KeyPoint& a, const cv::KeyPoint& b) {
                             return a.pt == b.pt && a.size == b.size;
                           }),
               points.end());
  if (static_cast<int>(points.size()) > options.count) {
    points.resize(static_cast<std::size_t>(options.count));
  }

  Features features;
  features.descriptors = Describe(small, points);
  const double sx = static_cast<double>(small.cols) / gray.cols;
  const double sy = static_cast<double>(small.rows) / gray.rows;
  for (std::size_t i = 0; i < points.size(); ++i) {
    features.pixels.emplace_back((points[i].pt.x + 0.5) / sx - 0.5,
                                 (points[i].pt.y + 0.5) / sy - 0.5);
    features.sizes.push_back(static_cast<float>(points[i].size / sx));
  }
  return features;
}

}  // namespace recollect::matching
