#pragma once

#include <opencv2/core/mat.hpp>

#include "recollect/geometry/camera.h"
#include "recollect/geometry/se3.h"

namespace recollect {

struct MotionDepthOptions {
  // Pixels by which the way there and back may miss its start, and by which the match may miss the
  // epipolar line.
  double consistency_px = 1;
  // Pixels that the camera's translation, without its rotation, must have moved a point: depth from
  // less is noise. Around the direction of travel nothing passes.
  double parallax_px = 1.5;
  double nearest_m = 1, farthest_m = 80;
};

// Depth of a still scene from two images of one moving camera whose motion is known: dense optical
// flow (DIS), checked both ways, then triangulation by least squares. image, other: rows x cols,
// 8 bit, one or three channels, of `camera`. Returns metres along z of `image`, 32-bit float, 0
// where unknown: without parallax, hidden in the other image, moving by itself.
// Throws Error where the images' sizes or types do not fit.
cv::Mat DepthFromMotion(const cv::Mat& image, const cv::Mat& other, const SE3& other_from_image,
                        const PinholeCamera& camera, const MotionDepthOptions& options = {});

}  // namespace recollect
