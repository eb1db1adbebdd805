#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>

#include "recollect/core/parallel.h"

namespace recollect::stereo {

// Disparities are 32-bit floats, u_left - u_right in pixels, for each pixel of the left image;
// kUnknown where there is none. Known ones are never negative.
inline constexpr float kUnknown = -1;

struct Kernel;

// The published settings of SPS-Stereo's front end (Yamaguchi, McAllester, Urtasun, ECCV 2014). The
// cost is fixed: Sobel gradients capped at 15 plus a sixth of the census' differing bits (5 x 5),
// summed over 5 x 5 pixels.
struct SgmOptions {
  int disparities = 128;     // 0 ... disparities - 1 are searched; a multiple of 16, 16 to 256
  int small_penalty = 100;   // P1, for a step of one along a path
  int large_penalty = 1600;  // P2, for any greater step
  int consistency = 1;       // px by which left and right disparity may differ; -1: no check
  int speckle_size = 100;    // connected patches of fewer pixels are unknown; 0: all stay
  double speckle_step = 2;   // px within which neighbours are connected
};

// Throws Error naming the option that is out of range.
void CheckOptions(const SgmOptions& options);

// Semi-global matching (Hirschmueller 2008) with eight paths. The same bits for any number of
// threads and any kernel.
class SemiGlobalMatcher {
 public:
  // Keeps its memory, 6 bytes for each pixel and disparity, from one pair to the next. Not to be
  // used by two threads at a time. kernel: null takes the fastest. Throws Error for bad options.
  SemiGlobalMatcher(const SgmOptions& options, ThreadPool& pool, const Kernel* kernel = nullptr);
  ~SemiGlobalMatcher();
  SemiGlobalMatcher(SemiGlobalMatcher&&) noexcept;

  // left, right: a rectified pair, rows x cols of 8-bit gray, 5 x 5 at least. Returns disparities
  // with sub-pixel parts from a parabola, kUnknown where left and right disagree, outside the right
  // image and in speckles. Throws Error where sizes or types do not fit.
  cv::Mat Disparity(const cv::Mat& left, const cv::Mat& right);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace recollect::stereo
