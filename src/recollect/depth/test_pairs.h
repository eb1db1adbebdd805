#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <opencv2/imgproc.hpp>

#include "recollect/core/random.h"

namespace recollect::stereo::testing {

// Stereo pairs with exact disparity.
struct Pair {
  cv::Mat left, right;  // 8-bit gray
  cv::Mat disparity;    // 32-bit float
};

inline cv::Mat Texture(int width, int height, std::uint64_t seed) {
  cv::Mat noise(height, width, CV_8U);
  Random random(seed);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) noise.at<uchar>(y, x) = static_cast<uchar>(random.Index(256));
  }
  cv::Mat smooth;
  cv::GaussianBlur(noise, smooth, cv::Size(), 1.2);
  cv::normalize(smooth, smooth, 0, 255, cv::NORM_MINMAX);
  return smooth;
}

// One textured surface with the disparity that is asked for; sampled bilinearly.
inline Pair Surface(int width, int height, const std::function<double(int, int)>& disparity) {
  Pair pair{cv::Mat(height, width, CV_8U), Texture(width, height, 3),
            cv::Mat(height, width, CV_32F)};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double d = disparity(x, y), from = std::clamp(x - d, 0.0, width - 1.0);
      const int before = static_cast<int>(from), after = std::min(before + 1, width - 1);
      const double value =
          std::lerp(static_cast<double>(pair.right.at<uchar>(y, before)),
                    static_cast<double>(pair.right.at<uchar>(y, after)), from - before);
      pair.left.at<uchar>(y, x) = static_cast<uchar>(std::lround(value));
      pair.disparity.at<float>(y, x) = static_cast<float>(d);
    }
  }
  return pair;
}

// A box at `near` px in front of a wall at `far` px. In the left image it covers `box`; the wall
// within near - far px to the left of it is hidden from the right camera.
inline Pair BoxBeforeWall(int width, int height, int near, int far, const cv::Rect& box) {
  const cv::Mat wall = Texture(width + far, height, 5), front = Texture(width + near, height, 6);
  Pair pair{cv::Mat(height, width, CV_8U), cv::Mat(height, width, CV_8U),
            cv::Mat(height, width, CV_32F)};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool on_box = box.contains({x, y}), box_in_right = box.contains({x + near, y});
      pair.left.at<uchar>(y, x) = (on_box ? front : wall).at<uchar>(y, x);
      pair.right.at<uchar>(y, x) =
          box_in_right ? front.at<uchar>(y, x + near) : wall.at<uchar>(y, x + far);
      pair.disparity.at<float>(y, x) = static_cast<float>(on_box ? near : far);
    }
  }
  return pair;
}

// Share of the pixels of `where` that are known and within `px` of the truth.
inline double Right(const cv::Mat& disparity, const cv::Mat& truth, double px,
                    const cv::Rect& where) {
  const cv::Mat good = (disparity(where) >= 0) & (cv::abs(disparity(where) - truth(where)) <= px);
  return static_cast<double>(cv::countNonZero(good)) / static_cast<double>(good.total());
}

}  // namespace recollect::stereo::testing
