#pragma once

#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "recollect/core/random.h"

namespace recollect::matching {

// Blobs of all sizes.
inline cv::Mat Blobs(int width, int height, std::uint64_t seed) {
  Random random(seed);
  cv::Mat image(height, width, CV_8UC1, cv::Scalar(110));
  for (int i = 0; i < width * height / 250; ++i) {
    const cv::Point centre(static_cast<int>(random.Index(width)),
                           static_cast<int>(random.Index(height)));
    const int radius = 1 + static_cast<int>(std::exp(random.Uniform(0, 3)));
    cv::ellipse(image, centre, {radius, 1 + radius / 2}, random.Uniform(0, 180), 0, 360,
                cv::Scalar(random.Uniform(0, 255)), cv::FILLED, cv::LINE_AA);
  }
  return image;
}

}  // namespace recollect::matching
