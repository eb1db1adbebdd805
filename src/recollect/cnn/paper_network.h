#pragma once

#include "recollect/cnn/pair_network.h"

namespace recollect::cnn {

// The paper's network (Fig. 3): a branch of three convolutions, shared by both images, whose
// outputs are concatenated and brought down to one position by strided convolutions; no pooling,
// PReLU after each layer but the last, dropout before each of the last two. Input 320 x 240, RGB
// in [0, 1]. The output layer starts at zero, so training starts from "no motion".
class PaperNetwork : public PairNetwork {
 public:
  // kind: kPaperA (the authors' default) or kPaperB (larger strides in the branch).
  explicit PaperNetwork(NetworkKind kind);
  Prediction forward(const torch::Tensor& live, const torch::Tensor& key) override;
  void TrainIn(Precision precision) override { half_ = precision == Precision::kBfloat16; }
  std::unique_ptr<PairEngine> MakeEngine(std::int64_t rows, std::int64_t columns,
                                         Precision precision) override;

  // The same as forward by libtorch's own layers, one after the other: what ours is measured
  // against.
  Prediction ForwardPlain(const torch::Tensor& live, const torch::Tensor& key);

  // The layers, for those who do them in another way.
  const torch::nn::Sequential& branch() const { return branch_; }
  const torch::nn::Sequential& top() const { return top_; }

 private:
  bool half_ = false;  // TrainIn
  torch::nn::Sequential branch_, top_;
};

}  // namespace recollect::cnn
