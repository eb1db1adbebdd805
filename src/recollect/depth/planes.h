#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "recollect/core/parallel.h"
#include "recollect/depth/kernel.h"

namespace recollect::stereo {

// The planes by which the pixels of one image are compared (kernel.h).
class MatchPlanes {
 public:
  // gray: rows x cols of 8 bits, 5 x 5 at least. mirror: rows are reversed and go on with `extra`
  // times their last value, as kernels want the right image.
  MatchPlanes(const cv::Mat& gray, bool mirror, int extra, ThreadPool& pool);

  PlaneRows Row(int y) const;

 private:
  void Fill(const cv::Mat& gray, int y, bool mirror);

  int stride_ = 0;
  std::vector<std::uint8_t> bytes_;  // [row][plane][stride_]
};

}  // namespace recollect::stereo
