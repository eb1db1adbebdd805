#pragma once

#include <opencv2/core/mat.hpp>
#include <span>

namespace recollect::cnn {

// Takes the light out of an image: every pixel less the mean of its neighbourhood (some 48 pixels
// wide), divided by the neighbourhood's mean absolute deviation, over all channels, plus three
// gray levels. planes: one a channel, 32-bit float from 0 to 255, without gaps between rows; in
// place, afterwards mostly within [-3, 3].
void NormaliseContrast(std::span<cv::Mat> planes);

}  // namespace recollect::cnn
