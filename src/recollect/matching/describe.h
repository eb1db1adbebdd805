#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

namespace recollect::matching {

// Scales that cv::SIFT's points are found at, as its defaults have them.
inline constexpr int kLayers = 3;          // an octave
inline constexpr double kBaseSigma = 1.6;  // pixels of the octave

// Upright SIFT descriptors (Lowe 2004, section 6) as RootSIFT (Arandjelovic and Zisserman 2012),
// kDescriptorBytes of 0 to 127 each, of points that cv::SIFT found in `gray` (8 bit). A patch is
// sampled at as many places whatever its scale: its blur grows with it, so that no more are needed.
std::vector<std::int8_t> Describe(const cv::Mat& gray, const std::vector<cv::KeyPoint>& points);

}  // namespace recollect::matching
