#include "recollect/cnn/paper_network.h"

#include <array>
#include <cmath>

#include "recollect/cnn/fast_layers.h"
#include "recollect/cnn/layers.h"
#include "recollect/cnn/paper_engine.h"
#include "recollect/core/error.h"

namespace recollect::cnn {
namespace {

// A convolution whose weights are drawn from N(0, sqrt(2 / (out k^2))), biases zero. They are kept
// channels-last, as the layers of training want them.
torch::nn::Conv2d Convolution(const torch::nn::Conv2dOptions& options) {
  torch::nn::Conv2d layer(options);
  const torch::Tensor weight = layer->weight;
  const auto fan_out = static_cast<double>(weight.size(0) * weight.size(2) * weight.size(3));
  torch::nn::init::normal_(layer->weight, 0.0, std::sqrt(2.0 / fan_out));
  torch::nn::init::zeros_(layer->bias);
  layer->weight.set_data(weight.contiguous(torch::MemoryFormat::ChannelsLast));
  return layer;
}

torch::nn::Conv2d Strided(int in, int out, int kernel, int stride) {
  return Convolution(torch::nn::Conv2dOptions(in, out, kernel).stride(stride).padding(kernel / 2));
}

// Layers that see so few cells are done as products.
constexpr std::int64_t kFewCells = 8;

torch::Tensor Run(torch::nn::SequentialImpl& layers, torch::Tensor x) {
  bool convolved = false;  // x is a convolution's result, which nobody else needs
  for (auto& module : layers) {
    if (const auto* prelu = module.ptr()->as<torch::nn::PReLU>(); prelu != nullptr) {
      x = convolved ? RectifyInPlace(x, prelu->weight) : torch::prelu(x, prelu->weight);
      convolved = false;
    } else if (const auto* layer = module.ptr()->as<torch::nn::Conv2d>(); layer != nullptr) {
      convolved = x.size(2) * x.size(3) > kFewCells;
      const bool last = layer->weight.size(0) == 6;
      x = convolved || last ? Convolve(x, *layer) : ConvolveAsProduct(x.to(torch::kFloat), *layer);
    } else {
      x = module.forward(x);
    }
  }
  return x;
}

}  // namespace

PaperNetwork::PaperNetwork(NetworkKind kind) {
  const bool a = kind == NetworkKind::kPaperA;
  Require(a || kind == NetworkKind::kPaperB, "PaperNetwork", "there are variants A and B only");
  const auto append = [](torch::nn::Sequential& to, torch::nn::Conv2d layer) {
    to->push_back(layer);
    to->push_back(torch::nn::PReLU());  // one slope, initially 0.25
  };
  append(branch_, a ? Strided(3, 64, 3, 2) : Strided(3, 64, 11, 4));
  append(branch_, a ? Strided(64, 64, 3, 2) : Strided(64, 64, 5, 2));
  append(branch_, Strided(64, 128, 3, 2));

  constexpr std::array<int, 6> kWidths = {256, 256, 256, 512, 1024, 4096};
  for (std::size_t i = 0; i + 1 < kWidths.size(); ++i) {
    append(top_, Strided(kWidths[i], kWidths[i + 1], 3, 2));
  }
  torch::nn::Conv2dOptions next(4096, 4096, 1), output(4096, 6, 1);
  if (a) {
    next = torch::nn::Conv2dOptions(4096, 4096, {1, 2}).padding(1);
    output = torch::nn::Conv2dOptions(4096, 6, 3);
  }
  top_->push_back(torch::nn::Dropout(0.5));
  append(top_, Convolution(next));
  top_->push_back(torch::nn::Dropout(0.5));
  torch::nn::Conv2d last = Convolution(output);
  torch::nn::init::zeros_(last->weight);
  top_->push_back(last);

  register_module("branch", branch_);
  register_module("top", top_);
}

Prediction PaperNetwork::forward(const torch::Tensor& live, const torch::Tensor& key) {
  if (!live.is_cpu()) return ForwardPlain(live, key);
  const std::int64_t batch = live.size(0);
  torch::Tensor x = torch::cat({live, key}).contiguous(torch::MemoryFormat::ChannelsLast);
  if (half_ && is_training()) x = x.to(torch::kBFloat16);
  x = Run(*branch_, x);
  x = Run(*top_, torch::cat({x.narrow(0, 0, batch), x.narrow(0, batch, batch)}, 1));
  Prediction prediction;
  prediction.motion = Se3Layer(x.flatten(1));
  return prediction;
}

std::unique_ptr<PairEngine> PaperNetwork::MakeEngine(std::int64_t rows, std::int64_t columns,
                                                     Precision precision) {
  return std::make_unique<PaperEngine>(branch_, top_, rows, columns, precision);
}

Prediction PaperNetwork::ForwardPlain(const torch::Tensor& live, const torch::Tensor& key) {
  const torch::Tensor fused = torch::cat({branch_->forward(live), branch_->forward(key)}, 1);
  Prediction prediction;
  prediction.motion = Se3Layer(top_->forward(fused).flatten(1));
  return prediction;
}

}  // namespace recollect::cnn
