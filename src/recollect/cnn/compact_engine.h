#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "recollect/cnn/correspondence.h"
#include "recollect/cnn/covariance_head.h"
#include "recollect/cnn/packed_layers.h"
#include "recollect/cnn/pair_engine.h"
#include "recollect/geometry/camera.h"

namespace recollect::cnn {

// What CompactNetwork is made of; it says what each part does. The last layers, `output` and
// `covariance`, are used as they are, all others are copied.
struct CompactParts {
  PinholeCamera cells;  // of the grid of cells
  torch::nn::Sequential branch, depth, motion, output;
  torch::nn::Conv2d context{nullptr};
  std::shared_ptr<CovarianceHead> covariance;  // may be null
  float sharpness = 1;
};

// The logarithm of the depth in metres that the untrained network takes all cells for, and the most
// it may say.
inline constexpr float kLogFirstDepth = 2.7080502F, kMostLogDepth = 6;

// The network's answer [B, 3, 4] from the motion that least squares found and what `output` says.
torch::Tensor Corrected(const torch::Tensor& solved, const torch::Tensor& raw);

// The compact network for images of one size: its convolutions on oneDNN with channels last, and
// what lies between them in one pass over the cells each.
class CompactEngine : public PairEngine {
 public:
  // grid: of the images it will be asked about.
  CompactEngine(const CompactParts& parts, const Grid& grid, Precision precision);

  PairAnswers Answer(const torch::Tensor& images, std::span<const ImagePair> pairs) override;

  // Where a live cell is seen: displacement in cells, and the share of the softmax around there.
  struct Peak {
    float column, row, share;
  };

 private:
  // A convolution whose result is normalised over each channel of each image, and rectified.
  struct Normalised {
    PackedConvolution convolution;
    torch::Tensor weight, bias;  // of the normalisation
  };
  // x + f(x).
  struct Residual {
    Normalised first;
    PackedConvolution second;
  };

  // Channels last from here on: [N, rows, columns, channels].
  torch::Tensor Convolve(PackedConvolution& layer, const torch::Tensor& source) const;
  torch::Tensor Convolve(Normalised& layer, const torch::Tensor& source) const;
  torch::Tensor Features(const torch::Tensor& images);
  void Sight(const std::vector<Peak>& peaks, const torch::Tensor& looks,
             const torch::Tensor& context, Sightings& sightings, std::int64_t at,
             const torch::Tensor& inputs) const;

  std::mutex mutex_;
  Grid grid_;
  Precision precision_;
  CompactParts parts_;
  torch::Tensor rays_;  // [3, cells]
  std::vector<Normalised> branch_;
  std::vector<Residual> residuals_;
  std::vector<PackedConvolution> depth_, motion_, context_;
};

}  // namespace recollect::cnn
