#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

namespace recollect::stereo {

// What matched points say about a pair before any disparity is computed.
struct PairCheck {
  int matches = 0;         // points that were found in the other image and back again
  double vertical_px = 0;  // median of the absolute difference of their rows
  double reversed = 0;     // share of those moved by a pixel or more that moved the wrong way
};

// left, right: 8-bit gray of one size. Corners followed into the other image and back by the
// pyramidal method of Lucas and Kanade.
PairCheck CheckPair(const cv::Mat& left, const cv::Mat& right);

// Throws Error, naming `where`, when the pair is swapped. Too few matches say nothing.
void RequireLeftIsLeft(const PairCheck& check, const std::string& where);

// A warning in one line when rows do not match as a rectified pair's do; empty otherwise.
std::string RectificationWarning(const PairCheck& check, const std::string& where);

}  // namespace recollect::stereo
