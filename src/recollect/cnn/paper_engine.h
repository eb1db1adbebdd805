#pragma once

#include <mutex>
#include <vector>

#include "recollect/cnn/convolution_taps.h"
#include "recollect/cnn/fixed_product.h"
#include "recollect/cnn/packed_layers.h"
#include "recollect/cnn/pair_engine.h"

namespace recollect::cnn {

// The paper's network for images of one size. Its last layers, which see few cells and hold nearly
// all of the weights, are matrix products in 32-bit floats without what meets only padding: reading
// the weights is what their time goes into.
class PaperEngine : public PairEngine {
 public:
  // branch, top: PaperNetwork's layers, which must bring the images down to one cell.
  PaperEngine(torch::nn::Sequential branch, torch::nn::Sequential top, std::int64_t image_rows,
              std::int64_t image_columns, Precision precision);

  PairAnswers Answer(const torch::Tensor& images, std::span<const ImagePair> pairs) override;

 private:
  // A layer as a product: the cells it takes of its input, then the product.
  struct Wide {
    ConvolutionTaps taps;
    FixedProduct product;

    // cells [batch, cells, channels] -> [batch, taps.outputs, channels].
    torch::Tensor Run(const torch::Tensor& cells) const;
  };
  dnnl::memory Fuse(const dnnl::memory& features, std::span<const ImagePair> pairs) const;

  std::mutex mutex_;
  dnnl::memory::data_type type_;
  std::vector<PackedConvolution> branch_, top_;
  std::vector<Wide> wide_;
  torch::Tensor last_weight_, last_bias_;  // of the output layer: [rows of wide, 6], [6]
};

}  // namespace recollect::cnn
