#include "recollect/geometry/camera.h"

#include "recollect/core/error.h"

namespace recollect {

Eigen::Matrix3d PinholeCamera::K() const {
  Eigen::Matrix3d k;
  k << fx, 0, cx, 0, fy, cy, 0, 0, 1;
  return k;
}

PinholeCamera PinholeCamera::Cropped(int left, int top, int window_width, int window_height) const {
  Require(left >= 0 && top >= 0 && window_width > 0 && window_height > 0 &&
              left + window_width <= width && top + window_height <= height,
          "crop",
          fmt::format("{}x{} at ({}, {}) leaves the {}x{} image", window_width, window_height, left,
                      top, width, height));
  return {window_width, window_height, fx, fy, cx - left, cy - top};
}

PinholeCamera PinholeCamera::Resized(int new_width, int new_height) const {
  Require(new_width > 0 && new_height > 0, "resize",
          fmt::format("{}x{} is no image size", new_width, new_height));
  const double sx = static_cast<double>(new_width) / width;
  const double sy = static_cast<double>(new_height) / height;
  return {new_width, new_height, fx * sx, fy * sy, (cx + 0.5) * sx - 0.5, (cy + 0.5) * sy - 0.5};
}

PinholeCamera PinholeCamera::Subsampled(int step) const {
  Require(step > 0, "subsample", fmt::format("step {} is not positive", step));
  return {(width + step - 1) / step,
          (height + step - 1) / step,
          fx / step,
          fy / step,
          cx / step,
          cy / step};
}

bool operator==(const PinholeCamera& a, const PinholeCamera& b) {
  return a.width == b.width && a.height == b.height && a.fx == b.fx && a.fy == b.fy &&
         a.cx == b.cx && a.cy == b.cy;
}

}  // namespace recollect
