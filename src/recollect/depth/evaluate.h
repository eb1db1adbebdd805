#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "recollect/core/progress.h"
#include "recollect/dataset/lap.h"
#include "recollect/depth/matcher.h"

namespace recollect::stereo {

// Errors of disparities over all pixels with true depth.
struct DisparityErrors {
  double density = 0;     // share that has a disparity
  double bad3 = 0;        // share off by more than 3 px, holes filled from the background
  double bad1 = 0;        // the same by more than 1 px
  double rel_median = 0;  // median of |depth - true depth| / true depth, holes filled
  double bad3_valid = 0;  // share off by more than 3 px of those that have a disparity
  // The same of pixels that the right camera sees, too.
  double bad3_visible = 0, bad3_visible_valid = 0;
  double ms = 0;  // wall time a pair, median; holes not filled
};

struct MethodErrors {
  Method method = Method::kSps;
  DisparityErrors errors;
};

struct DepthEvaluation {
  int frames = 0;
  std::int64_t pixels = 0;  // with true depth
  double visible = 0;       // share of them that the right camera sees
  std::vector<MethodErrors> methods;
};

// For pixels with a true disparity (32-bit float; column i is column i * step of the left image;
// <= 0 unknown): 255 where the right camera sees it, too, 0 where something nearer hides it or it
// lies outside the right image. width: of the images.
cv::Mat SeenByRight(const cv::Mat& true_disparity, int step, int width);

// sps, sgm and sgbm, side by side, on every `every`-th of a lap's frames that have a right image
// and true depth. Throws Error where there is no such frame.
DepthEvaluation EvaluateDepth(const Lap& lap, const MatchOptions& options, int every,
                              ThreadPool& pool, const ProgressSink& progress = {});

}  // namespace recollect::stereo
