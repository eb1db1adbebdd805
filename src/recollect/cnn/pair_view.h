#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "recollect/cnn/pair_data.h"
#include "recollect/core/random.h"

namespace recollect::cnn {

// What is learnt from a pair: two crops, depth of the live one, and the true motion.
struct PairView {
  cv::Mat live, key;   // 8-bit B, G, R
  cv::Mat live_depth;  // as StoredFrame::depth
  SE3 keyframe_from_live;
};

PairView ViewOf(const PairData& data, const Pair& pair);

struct ViewOptions {
  double turn_rad = 0;  // each camera by itself is turned by up to this about each of its axes
  bool mirror = false;  // half of the pairs, drawn at random, are seen in a mirror

  bool Any() const { return turn_rad > 0 || mirror; }
};

// The pair as cameras would see it whose axes are others: p' = changed_from_camera * p, an
// orthogonal matrix (a rotation about the camera's centre, a mirror, or both; both of a pair are
// mirrored or neither). The intrinsics stay, so a mirror is one through the optical axis. What no
// camera has seen repeats the image's border and has no depth.
void ChangeView(PairView& pair, const PinholeCamera& crop_camera,
                const Eigen::Matrix3d& changed_from_live, const Eigen::Matrix3d& changed_from_key);

// ChangeView at random.
void AugmentView(PairView& pair, const PinholeCamera& crop_camera, const ViewOptions& options,
                 Random& random);

}  // namespace recollect::cnn
