#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "recollect/core/random.h"
#include "recollect/wnn/encoder.h"

namespace recollect::wnn {

// Coloured blobs of all sizes, with grain; the seed makes the place.
inline cv::Mat Scene(std::uint64_t seed, int width = 320, int height = 240) {
  Random random(seed);
  cv::Mat image(height, width, CV_8UC3, cv::Scalar(100, 110, 120));
  for (int i = 0; i < 150; ++i) {
    const cv::Point centre(static_cast<int>(random.Index(width)),
                           static_cast<int>(random.Index(height)));
    const cv::Scalar colour(random.Uniform(30, 190), random.Uniform(30, 190),
                            random.Uniform(30, 190));
    cv::circle(image, centre, 2 + static_cast<int>(random.Index(25)), colour, cv::FILLED);
  }
  cv::Mat grain(height / 4, width / 4, CV_8UC3);
  for (int y = 0; y < grain.rows; ++y) {
    for (int x = 0; x < 3 * grain.cols; ++x) {
      grain.ptr(y)[x] = static_cast<std::uint8_t>(random.Index(30));
    }
  }
  cv::resize(grain, grain, image.size(), 0, 0, cv::INTER_LINEAR);
  return image + grain;
}

inline ImageView View(const cv::Mat& image) {
  return {image.data, image.cols, image.rows, image.channels(),
          static_cast<std::ptrdiff_t>(image.step)};
}

}  // namespace recollect::wnn
