#pragma once

#include <Eigen/Core>

namespace recollect {

// A distortion-free pinhole camera; axes x right, y down, z forward. Lengths in pixels. Pixel
// (u, v) with whole numbers is the *centre* of that pixel, so the image spans
// [-0.5, width - 0.5) x [-0.5, height - 0.5).
struct PinholeCamera {
  int width = 0, height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;

  Eigen::Vector2d Project(const Eigen::Vector3d& p) const {
    return {fx * p.x() / p.z() + cx, fy * p.y() / p.z() + cy};
  }
  // The point at `depth` metres along z that is seen in pixel (u, v).
  Eigen::Vector3d Unproject(double u, double v, double depth) const {
    return {depth * (u - cx) / fx, depth * (v - cy) / fy, depth};
  }
  bool Contains(const Eigen::Vector2d& pixel) const {
    return pixel.x() >= -0.5 && pixel.y() >= -0.5 && pixel.x() < width - 0.5 &&
           pixel.y() < height - 0.5;
  }
  Eigen::Matrix3d K() const;

  // The camera of the window of `window_width` x `window_height` pixels whose first pixel is
  // (left, top). Throws Error where the window leaves the image.
  PinholeCamera Cropped(int left, int top, int window_width, int window_height) const;
  // The camera of the image resampled to the given size over the same field of view (as
  // cv::resize does: pixel areas, not pixel centres, are scaled).
  PinholeCamera Resized(int new_width, int new_height) const;
  // The camera of every `step`-th pixel of every `step`-th row, beginning with the first.
  PinholeCamera Subsampled(int step) const;
};

bool operator==(const PinholeCamera& a, const PinholeCamera& b);

// A rectified pair: the right camera looks the same way from `baseline` metres along +x of the
// left one. The left camera is the reference everywhere in this project.
struct StereoCamera {
  PinholeCamera left;
  double baseline = 0;  // metres; 0 where there is no right camera

  // Depth along z in metres of a disparity u_left - u_right > 0 in pixels.
  double Depth(double disparity) const { return left.fx * baseline / disparity; }
};

}  // namespace recollect
