#pragma once

#include <opencv2/core/mat.hpp>

namespace recollect::wnn {

// The first `rows` rows of an 8-bit image scaled to `size`: cv::resize with INTER_AREA, bit for
// bit, but where both sides shrink by one whole factor of three or more a good deal faster.
cv::Mat Shrunk(const cv::Mat& image, cv::Size size, int rows);

}  // namespace recollect::wnn
