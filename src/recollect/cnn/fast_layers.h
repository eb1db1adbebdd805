#pragma once

#include <torch/torch.h>

// Layers for training that give what libtorch's own do, faster: without putting weights and images
// into another order and back at each step. All are differentiable, and fall back to libtorch's
// where there is no way of their own (other devices, double precision).
namespace recollect::cnn {

// A convolution in the precision of x, float or bfloat16; the weights are kept in float.
torch::Tensor Convolve(const torch::Tensor& x, const torch::nn::Conv2dImpl& layer);

// PReLU of one slope [1], in the place of x, float or bfloat16, which must be the result of a layer
// that does not need it on the way back (a convolution).
torch::Tensor RectifyInPlace(const torch::Tensor& x, const torch::Tensor& slope);

// A convolution over few cells as one matrix product (ConvolutionTaps). x [B, I, H, W]; weights are
// best kept channels-last, so that the matrix lies in memory as it is used.
torch::Tensor ConvolveAsProduct(const torch::Tensor& x, const torch::nn::Conv2dImpl& layer);

}  // namespace recollect::cnn
