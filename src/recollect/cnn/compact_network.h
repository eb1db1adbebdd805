#pragma once

#include "recollect/cnn/covariance_head.h"
#include "recollect/cnn/pair_network.h"

namespace recollect::cnn {

// Side of a cell of the compact network's feature grid, in pixels of its input: cell (x, y) is
// centred on pixel (8 x, 8 y).
inline constexpr int kCellPixels = 8;

// The network of this project: it compares the images before it regresses. With about 1 M
// parameters and a pooled head it takes inputs of any size divisible by 16.
//  1. A shared branch gives every cell of 8 x 8 pixels a feature of unit length.
//  2. The correlation of all live cells with all key-frame cells is one matrix product; its
//     softmax over the key frame says where each live cell is seen there. Around its peak the
//     expected displacement and the share of the probability are read off.
//  3. Two small heads tell from a live cell's looks how deep it lies and how far it is to be
//     trusted.
//  4. With that the motion that explains the displacements best follows by least squares
//     (SolveMotion).
//  5. Strided convolutions over displacement, share, depth, trust and place in the image, pooled to
//     3 x 5, and two linear layers correct it by six numbers. Their output layer starts at zero.
//  6. Optionally a CovarianceHead tells from the same features how sure the answer is.
// Input: images with normalised contrast (NormaliseContrast).
class CompactNetwork : public PairNetwork {
 public:
  explicit CompactNetwork(const PinholeCamera& camera, bool covariance = false);
  Prediction forward(const torch::Tensor& live, const torch::Tensor& key) override;
  std::unique_ptr<PairEngine> MakeEngine(std::int64_t rows, std::int64_t columns,
                                         Precision precision) override;

 private:
  PinholeCamera cells_;  // of the grid of cells
  torch::nn::Sequential branch_, depth_, motion_, output_;
  torch::nn::Conv2d context_{nullptr};
  std::shared_ptr<CovarianceHead> covariance_;  // none where it is not wanted
  torch::Tensor log_sharpness_;  // of the softmax: logarithm of the inverse temperature
};

}  // namespace recollect::cnn
