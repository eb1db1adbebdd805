#pragma once

#include <torch/torch.h>

#include "recollect/geometry/camera.h"
#include "recollect/geometry/se3.h"

// Layers without weights. B is the batch, H x W a grid of pixels.
namespace recollect::cnn {

// SE3 layer (paper, section III-C): delta [B, 6] = (rotation vector in radians, translation in
// metres) -> motion [B, 3, 4] = [R | t], R by Rodrigues' formula, by its series near zero.
torch::Tensor Se3Layer(const torch::Tensor& delta);

// Directions K^-1 (u, v, 1)^T of every pixel of the camera's image: [3, H, W], float.
torch::Tensor RayGrid(const PinholeCamera& camera);

// 3D grid layer: p(u, v) = d(u, v) K^-1 (u, v, 1)^T. depth [B, H, W] in metres along z and rays
// [3, H, W] -> points [B, 3, H W] in metres in the camera's frame.
torch::Tensor Grid3d(const torch::Tensor& depth, const torch::Tensor& rays);

// motion [B, 3, 4] applied to points [B, 3, N] -> [B, 3, N].
torch::Tensor Transform(const torch::Tensor& motion, const torch::Tensor& points);

// SE3::Log of motions [B, 3, 4], rotations by less than pi: [B, 6], rotation first.
torch::Tensor Se3Log(const torch::Tensor& motion);

// x with T_a Exp(x) = T_b, of motions [B, 3, 4]: [B, 6].
torch::Tensor Se3Difference(const torch::Tensor& a, const torch::Tensor& b);

// (rotation vector, translation) of a motion, the form of the network's output.
Vector6d DeltaFromMotion(const SE3& keyframe_from_live);
SE3 MotionFromDelta(const Vector6d& delta);

}  // namespace recollect::cnn
