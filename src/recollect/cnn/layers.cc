#include "recollect/cnn/layers.h"

namespace recollect::cnn {

torch::Tensor Se3Layer(const torch::Tensor& delta) {
  const torch::Tensor w = delta.slice(1, 0, 3), t = delta.slice(1, 3, 6);
  // Rodrigues: R = I + a [w]x + b [w]x^2, a = sin|w| / |w|, b = (1 - cos|w|) / |w|^2. Both are
  // smooth in s = |w|^2, but their closed forms are 0/0 at zero: there the series is taken, and
  // the closed form is given a harmless s so that its unused gradient stays finite.
  const torch::Tensor s = w.square().sum(1, true);
  const torch::Tensor small = s < 1e-2;
  const torch::Tensor angle = torch::where(small, torch::ones_like(s), s).sqrt();
  const torch::Tensor half = 2.0 / angle * (angle / 2.0).sin();  // sqrt(2 b), without cancellation
  const torch::Tensor series_a =
      1.0 - s / 6.0 * (1.0 - s / 20.0 * (1.0 - s / 42.0 * (1.0 - s / 72.0)));
  const torch::Tensor series_b =
      0.5 - s / 24.0 * (1.0 - s / 30.0 * (1.0 - s / 56.0 * (1.0 - s / 90.0)));
  const torch::Tensor a = torch::where(small, series_a, angle.sin() / angle);
  const torch::Tensor b = torch::where(small, series_b, half.square() / 2.0);

  const torch::Tensor x = w.select(1, 0), y = w.select(1, 1), z = w.select(1, 2);
  const torch::Tensor zero = torch::zeros_like(x);
  const torch::Tensor hat =
      torch::stack({zero, -z, y, z, zero, -x, -y, x, zero}, 1).view({-1, 3, 3});
  const torch::Tensor identity = torch::eye(3, delta.options()).unsqueeze(0);
  const torch::Tensor rotation =
      identity + a.unsqueeze(2) * hat + b.unsqueeze(2) * torch::bmm(hat, hat);
  return torch::cat({rotation, t.unsqueeze(2)}, 2);
}

torch::Tensor RayGrid(const PinholeCamera& camera) {
  torch::Tensor rays = torch::empty({3, camera.height, camera.width});
  auto out = rays.accessor<float, 3>();
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d ray = camera.Unproject(u, v, 1.0);
      for (int i = 0; i < 3; ++i) out[i][v][u] = static_cast<float>(ray[i]);
    }
  }
  return rays;
}

torch::Tensor Grid3d(const torch::Tensor& depth, const torch::Tensor& rays) {
  return (depth.unsqueeze(1) * rays.unsqueeze(0)).flatten(2);
}

torch::Tensor Transform(const torch::Tensor& motion, const torch::Tensor& points) {
  return torch::matmul(motion.slice(2, 0, 3), points) + motion.slice(2, 3, 4);
}

torch::Tensor Se3Log(const torch::Tensor& motion) {
  const torch::Tensor r = motion.slice(2, 0, 3), t = motion.slice(2, 3, 4);
  const auto skew = [&](int row, int column) {
    return (r.select(1, row).select(1, column) - r.select(1, column).select(1, row)) / 2.0;
  };
  const torch::Tensor axis = torch::stack({skew(2, 1), skew(0, 2), skew(1, 0)}, 1);  // sin(angle) n
  const torch::Tensor cosine =
      ((r.select(1, 0).select(1, 0) + r.select(1, 1).select(1, 1) + r.select(1, 2).select(1, 2)) -
       1.0) /
      2.0;
  // As in Se3Layer, series near zero, where the closed forms are given a harmless number.
  const torch::Tensor square = axis.square().sum(1);
  const torch::Tensor small = (square < 1e-2) & (cosine > 0);
  const torch::Tensor sine = torch::where(small, torch::ones_like(square), square).sqrt();
  const torch::Tensor angle = torch::atan2(sine, cosine);
  const torch::Tensor series =
      1.0 +
      square / 6.0 *
          (1.0 + square * 9.0 / 20.0 * (1.0 + square * 25.0 / 42.0 * (1.0 + square * 49.0 / 72.0)));
  const torch::Tensor w = axis * torch::where(small, series, angle / sine).unsqueeze(1);

  // J_l(w)^-1 t = t - w x t / 2 + c w x (w x t).
  const torch::Tensor s = w.square().sum(1);
  const torch::Tensor half = torch::where(small, torch::ones_like(s), s).sqrt() / 2.0;
  const torch::Tensor series_c = 1.0 / 12.0 + s / 720.0 * (1.0 + s / 42.0 * (1.0 + s / 40.0));
  const torch::Tensor closed_c = (1.0 - half / half.tan()) / (4.0 * half.square());
  const torch::Tensor c = torch::where(small, series_c, closed_c).unsqueeze(1);
  const torch::Tensor v = t.squeeze(2);
  const torch::Tensor turned = torch::cross(w, v, 1);
  return torch::cat({w, v - turned / 2.0 + c * torch::cross(w, turned, 1)}, 1);
}

torch::Tensor Se3Difference(const torch::Tensor& a, const torch::Tensor& b) {
  const torch::Tensor back = a.slice(2, 0, 3).transpose(1, 2);
  const torch::Tensor moved = b.slice(2, 3, 4) - a.slice(2, 3, 4);
  return Se3Log(torch::bmm(back, torch::cat({b.slice(2, 0, 3), moved}, 2)));
}

Vector6d DeltaFromMotion(const SE3& keyframe_from_live) {
  Vector6d delta;
  delta << keyframe_from_live.RotationVector(), keyframe_from_live.translation();
  return delta;
}

SE3 MotionFromDelta(const Vector6d& delta) {
  return SE3::FromRotationVector(delta.head<3>(), delta.tail<3>());
}

}  // namespace recollect::cnn
