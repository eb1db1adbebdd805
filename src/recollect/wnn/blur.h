#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "recollect/wnn/kernel.h"

namespace recollect::wnn {

// cv::GaussianBlur of 8-bit images with BORDER_REFLECT_101, bit for bit, row by row and without
// allocating: its weights are 256ths, so nothing is rounded but the result, and any order of
// summing gives the same.
class Blur {
 public:
  // size: side of the kernel in pixels, odd; sigma in pixels. Works on up to `strips` rows at a
  // time, of at most 3 channels.
  Blur(int width, int height, int size, double sigma, int strips);

  // Row y of the blurred image, width x channels bytes. Calls with different strips may run at the
  // same time.
  void Row(const Kernel& kernel, const cv::Mat& image, int y, int strip, std::uint8_t* out);

 private:
  int width_, height_;
  std::vector<std::uint16_t> weights_;
  std::vector<int> border_;  // columns that stand for those beside the image, left to right
  struct Scratch {
    std::vector<const std::uint8_t*> rows;
    std::vector<std::int16_t> sums;
  };
  std::vector<Scratch> scratch_;  // by strip
};

}  // namespace recollect::wnn
