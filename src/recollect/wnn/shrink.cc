#include "recollect/wnn/shrink.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace recollect::wnn {
namespace {

// Means of kChannels interleaved channels over squares of factor x factor pixels.
template <int kChannels>
cv::Mat Means(const cv::Mat& image, int factor, int columns, int rows) {
  cv::Mat means(rows, columns, image.type());
  const int used = columns * factor * kChannels;
  const float scale = 1.f / static_cast<float>(factor * factor);
  std::vector<std::uint16_t> sums(static_cast<std::size_t>(used));
  std::uint16_t* const sum = sums.data();
  for (int y = 0; y < rows; ++y) {
    std::fill(sums.begin(), sums.end(), std::uint16_t{0});
    for (int k = 0; k < factor; ++k) {
      const std::uint8_t* row = image.ptr(y * factor + k);
      for (int x = 0; x < used; ++x) sum[x] = static_cast<std::uint16_t>(sum[x] + row[x]);
    }
    std::uint8_t* mean = means.ptr(y);
    for (int x = 0; x < columns; ++x) {
      for (int c = 0; c < kChannels; ++c) {
        int all = 0;
        for (int k = 0; k < factor; ++k) all += sum[(x * factor + k) * kChannels + c];
        *mean++ = cv::saturate_cast<std::uint8_t>(static_cast<float>(all) * scale);
      }
    }
  }
  return means;
}

}  // namespace

cv::Mat Shrunk(const cv::Mat& image, cv::Size size, int rows) {
  const int factor = image.cols / size.width;
  const bool whole = factor >= 3 && factor <= 16 && image.cols == factor * size.width &&
                     image.rows == factor * size.height;
  if (whole && image.channels() == 3) return Means<3>(image, factor, size.width, rows);
  if (whole && image.channels() == 1) return Means<1>(image, factor, size.width, rows);
  cv::Mat shrunk;
  cv::resize(image, shrunk, size, 0, 0, cv::INTER_AREA);
  return shrunk.rowRange(0, rows);
}

}  // namespace recollect::wnn
