#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "recollect/depth/sgm.h"
#include "recollect/depth/slanted_planes.h"
#include "recollect/depth/superpixels.h"

namespace recollect::stereo {

// Slanted-plane smoothing (Yamaguchi, McAllester, Urtasun: Efficient Joint Segmentation, Occlusion
// Labeling, Stereo and Flow Estimation, ECCV 2014), with the published settings.
struct SpsOptions {
  int superpixels = 1000;
  int outer_rounds = 10;  // of moving pixels and refitting planes in turn
  int inner_rounds = 10;  // of labelling boundaries and refitting planes in turn, in each
  SegmentWeights segments;
  PlaneOptions planes;
};

// Throws Error naming the option that is out of range.
void CheckOptions(const SpsOptions& options);

struct SlantedPlaneResult {
  cv::Mat disparity;  // rows x cols of 32-bit floats, never negative: dense
  cv::Mat measured;   // rows x cols of 8 bits: 255 where the input agrees with it, 0 where the
                      // plane only goes on over unknown or outlying pixels
  cv::Mat labels;     // rows x cols of 32 bits: each pixel's superpixel
  std::vector<Plane> planes;         // of the superpixels
  std::vector<Boundary> boundaries;  // each pair of superpixels that touch
};

// Smooths the disparities of a left image into one plane a superpixel; every pixel gets one.
// left: rows x cols, 8 bits, gray or B, G, R. disparity: 32-bit float, negative where unknown
// (sgm.h). Deterministic. Throws Error where sizes or types do not fit or no disparity is known.
SlantedPlaneResult SmoothBySlantedPlanes(const cv::Mat& left, const cv::Mat& disparity,
                                         const SpsOptions& options = {});

}  // namespace recollect::stereo
