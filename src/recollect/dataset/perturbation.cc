#include "recollect/dataset/perturbation.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "recollect/core/error.h"
#include "recollect/core/random.h"

namespace recollect {
namespace {

// Light: gamma, gain, shading over the image, colour of the lamp, noise.
void Relight(cv::Mat& image, Random& random, const Perturbation& by) {
  const double gamma = std::exp(random.Uniform(-by.gamma, by.gamma));
  const double gain = std::exp(random.Uniform(-by.gain, by.gain));
  const double shade_x = random.Uniform(-by.shade, by.shade);
  const double shade_y = random.Uniform(-by.shade, by.shade);
  const double tint[3] = {1 + random.Uniform(-by.tint, by.tint), 1,
                          1 + random.Uniform(-by.tint, by.tint)};
  for (int y = 0; y < image.rows; ++y) {
    auto* row = image.ptr<cv::Vec3b>(y);
    const double down = 1 + shade_y * (2.0 * y / image.rows - 1);
    for (int x = 0; x < image.cols; ++x) {
      const double light = gain * down * (1 + shade_x * (2.0 * x / image.cols - 1));
      const double noise = by.noise * random.Normal();
      for (int c = 0; c < 3; ++c) {
        const double value = std::pow(row[x][c] / 255.0, gamma) * light * tint[c] * 255 + noise;
        row[x][c] = cv::saturate_cast<std::uint8_t>(value);
      }
    }
  }
}

}  // namespace

cv::Mat Perturbed(const cv::Mat& image, std::uint64_t seed, const Perturbation& by) {
  Require(image.type() == CV_8UC3 && !image.empty(), "image", "is not 8-bit colour");
  Random random(seed);
  const cv::Point2f centre(static_cast<float>(image.cols) / 2, static_cast<float>(image.rows) / 2);
  cv::Mat motion = cv::getRotationMatrix2D(centre, random.Uniform(-by.turn_deg, by.turn_deg),
                                           1 + random.Uniform(-by.scale, by.scale));
  motion.at<double>(0, 2) += image.cols * random.Uniform(-by.shift_x, by.shift_x);
  motion.at<double>(1, 2) += image.cols * random.Uniform(-by.shift_y, by.shift_y);
  cv::Mat seen;
  cv::warpAffine(image, seen, motion, image.size(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  Relight(seen, random, by);
  const int width = static_cast<int>(image.cols * random.Uniform(0, by.cover));
  const int height = static_cast<int>(image.rows * random.Uniform(0, by.cover));
  const cv::Scalar colour(random.Uniform(0, 128), random.Uniform(0, 128), random.Uniform(0, 128));
  const cv::Point at(static_cast<int>(random.Index(image.cols - width)),
                     static_cast<int>(random.Index(image.rows - height)));
  cv::rectangle(seen, cv::Rect(at, cv::Size(width, height)), colour, cv::FILLED);
  return seen;
}

}  // namespace recollect
