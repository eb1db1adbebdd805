#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>

#include "recollect/geometry/camera.h"

namespace recollect::stereo {

// Fills what is unknown as the KITTI stereo benchmark does: of the nearest known disparities to the
// left and right the smaller, which is the background; at a row's end the one there is; rows
// without any from the rows above and below in the same way.
cv::Mat FillFromBackground(const cv::Mat& disparity);

// Metres along z, 32-bit float, 0 where the disparity is unknown. A disparity of zero is infinitely
// far and comes out as infinity.
cv::Mat DepthFromDisparity(const cv::Mat& disparity, const StereoCamera& camera);

// Writes a depth image as laps have it (docs/data.md): 16-bit PNG in steps of 0.01 m, 0 where depth
// is 0 (unknown); what is farther than 655.35 m is written as that. Throws Error as AtomicWrite.
void WriteDepth(const std::filesystem::path& path, const cv::Mat& depth);

// Disparities as colours, 8-bit B, G, R: red is near (`greatest` px and more), blue far, black
// unknown.
cv::Mat ColourDisparity(const cv::Mat& disparity, double greatest);

// Disparity that 2 % of the known ones exceed: a `greatest` for ColourDisparity. At least 1.
double GreatestDisparity(const cv::Mat& disparity);

}  // namespace recollect::stereo
