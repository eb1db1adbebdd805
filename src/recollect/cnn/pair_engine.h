#pragma once

#include <torch/torch.h>

#include <cstdint>
#include <span>

namespace recollect::cnn {

// Which of the images given together are compared.
struct ImagePair {
  std::int64_t live = 0, key = 0;
};

struct PairAnswers {
  torch::Tensor motion, whitening, agreement;  // as in Prediction
};

// The way forward alone, on the processor, made from a network's weights as they were at the time.
// May be asked from several threads; they wait for each other.
class PairEngine {
 public:
  virtual ~PairEngine() = default;

  // images [N, 3, H, W] as the network takes them. What is made of an image alone is made once,
  // however many pairs it is in.
  virtual PairAnswers Answer(const torch::Tensor& images, std::span<const ImagePair> pairs) = 0;
};

}  // namespace recollect::cnn
