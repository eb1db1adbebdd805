#pragma once

#include <opencv2/core/mat.hpp>

namespace recollect::cnn {

// Takes the light out of an image: every pixel less the mean of its neighbourhood (some 48 pixels
// wide), divided by the neighbourhood's mean absolute deviation, over all channels, plus three
// gray levels. rows x cols of 8-bit B, G, R -> 32-bit float B, G, R, mostly within [-3, 3].
cv::Mat NormaliseContrast(const cv::Mat& image);

}  // namespace recollect::cnn
