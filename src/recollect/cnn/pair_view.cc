#include "recollect/cnn/pair_view.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace recollect::cnn {
namespace {

cv::Mat ChangeImage(const cv::Mat& image, const PinholeCamera& camera,
                    const Eigen::Matrix3d& changed_from_camera) {
  const Eigen::Matrix3d k = camera.K();
  const Eigen::Matrix3d image_from_changed = k * changed_from_camera.transpose() * k.inverse();
  cv::Matx33d values;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      values(row, column) = image_from_changed(row, column);
  }
  cv::Mat out;
  cv::warpPerspective(image, out, values, image.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                      cv::BORDER_REPLICATE);
  return out;
}

// The depth between the pixels; 0 where it is unknown. On a plane 1 / z is linear in the image, so
// it is interpolated where the four pixels around look like one; else the nearest counts.
double DepthAt(const cv::Mat& depth, const Eigen::Vector2d& at) {
  constexpr double kSamePlane = 1.25;  // greatest over least
  const int column = std::clamp(static_cast<int>(std::floor(at.x())), 0, depth.cols - 2);
  const int row = std::clamp(static_cast<int>(std::floor(at.y())), 0, depth.rows - 2);
  const double right = std::clamp(at.x() - column, 0.0, 1.0);
  const double down = std::clamp(at.y() - row, 0.0, 1.0);
  const std::array<double, 4> z = {depth.at<float>(row, column), depth.at<float>(row, column + 1),
                                   depth.at<float>(row + 1, column),
                                   depth.at<float>(row + 1, column + 1)};
  const auto [least, greatest] = std::minmax_element(z.begin(), z.end());
  if (*least <= 0 || *greatest > kSamePlane * *least) {
    return z[(down < 0.5 ? 0U : 2U) + (right < 0.5 ? 0U : 1U)];
  }
  return 1 / std::lerp(std::lerp(1 / z[0], 1 / z[1], right), std::lerp(1 / z[2], 1 / z[3], right),
                       down);
}

cv::Mat ChangeDepth(const cv::Mat& depth, const PinholeCamera& crop_camera,
                    const Eigen::Matrix3d& changed_from_camera) {
  const PinholeCamera grid = crop_camera.Subsampled(kDepthStep);
  cv::Mat out = cv::Mat::zeros(depth.size(), CV_32F);
  for (int v = 0; v < out.rows; ++v) {
    for (int u = 0; u < out.cols; ++u) {
      const Eigen::Vector3d ray = changed_from_camera.transpose() * grid.Unproject(u, v, 1);
      if (ray.z() <= 0 || !crop_camera.Contains(crop_camera.Project(ray))) continue;
      // The point on this ray at depth z is at z / ray.z() along the changed camera's axis.
      out.at<float>(v, u) = static_cast<float>(DepthAt(depth, grid.Project(ray)) / ray.z());
    }
  }
  return out;
}

}  // namespace

PairView ViewOf(const PairData& data, const Pair& pair) {
  return {data.frames[pair.live].image, data.frames[pair.key].image, data.frames[pair.live].depth,
          data.KeyframeFromLive(pair)};
}

void ChangeView(PairView& pair, const PinholeCamera& crop_camera,
                const Eigen::Matrix3d& changed_from_live, const Eigen::Matrix3d& changed_from_key) {
  pair.live = ChangeImage(pair.live, crop_camera, changed_from_live);
  pair.key = ChangeImage(pair.key, crop_camera, changed_from_key);
  if (!pair.live_depth.empty()) {
    pair.live_depth = ChangeDepth(pair.live_depth, crop_camera, changed_from_live);
  }
  const SE3& motion = pair.keyframe_from_live;
  pair.keyframe_from_live = {changed_from_key * motion.rotation() * changed_from_live.transpose(),
                             changed_from_key * motion.translation()};
}

void AugmentView(PairView& pair, const PinholeCamera& crop_camera, const ViewOptions& options,
                 Random& random) {
  const auto turn = [&] {
    Eigen::Vector3d angles;
    for (double& angle : angles) angle = random.Uniform(-options.turn_rad, options.turn_rad);
    return ExpSo3(angles);
  };
  Eigen::Matrix3d live = turn(), key = turn();
  if (options.mirror && random.Uniform() < 0.5) {
    const Eigen::DiagonalMatrix<double, 3> mirror(-1, 1, 1);
    live = live * mirror;
    key = key * mirror;
  }
  ChangeView(pair, crop_camera, live, key);
}

}  // namespace recollect::cnn
