#include "recollect/cnn/compact_network.h"

#include <cmath>

#include "recollect/cnn/compact_engine.h"
#include "recollect/cnn/correspondence.h"
#include "recollect/cnn/layers.h"
#include "recollect/cnn/motion_solver.h"
#include "recollect/core/error.h"

namespace recollect::cnn {
namespace {

constexpr int kFeatures = 64;
constexpr int kContext = 16;
constexpr int kMotionFeatures = 128;
constexpr int kPooledRows = 3, kPooledColumns = 5;

torch::nn::Conv2d Convolution(int in, int out, int kernel, int stride) {
  torch::nn::Conv2d layer(
      torch::nn::Conv2dOptions(in, out, kernel).stride(stride).padding(kernel / 2));
  torch::nn::init::kaiming_normal_(layer->weight, 0.25, torch::kFanIn, torch::kLeakyReLU);
  torch::nn::init::zeros_(layer->bias);
  return layer;
}

// Convolution, normalisation over each channel of each image, rectification.
void AppendNormalised(torch::nn::Sequential& to, int in, int out, int kernel, int stride) {
  to->push_back(Convolution(in, out, kernel, stride));
  to->push_back(torch::nn::GroupNorm(torch::nn::GroupNormOptions(out, out)));
  to->push_back(torch::nn::ReLU(torch::nn::ReLUOptions(true)));
}

// x + f(x), f two convolutions.
class ResidualImpl : public torch::nn::Module {
 public:
  explicit ResidualImpl(int channels) {
    AppendNormalised(inner_, channels, channels, 3, 1);
    inner_->push_back(Convolution(channels, channels, 3, 1));
    register_module("inner", inner_);
  }
  torch::Tensor forward(const torch::Tensor& x) { return x + inner_->forward(x); }

 private:
  torch::nn::Sequential inner_;
};
TORCH_MODULE(Residual);

}  // namespace

CompactNetwork::CompactNetwork(const PinholeCamera& camera, bool covariance)
    : cells_(camera.Subsampled(kCellPixels)) {
  AppendNormalised(branch_, 3, 48, 7, 4);
  AppendNormalised(branch_, 48, kFeatures, 3, 2);
  branch_->push_back(Residual(kFeatures));
  branch_->push_back(Residual(kFeatures));

  depth_->push_back(Convolution(kFeatures, 32, 3, 2));
  depth_->push_back(torch::nn::PReLU());
  depth_->push_back(Convolution(32, 32, 3, 1));
  depth_->push_back(torch::nn::PReLU());
  depth_->push_back(torch::nn::Upsample(
      torch::nn::UpsampleOptions().scale_factor(std::vector<double>{2, 2}).mode(torch::kNearest)));
  torch::nn::Conv2d looks = Convolution(32, 2, 3, 1);
  torch::nn::init::zeros_(looks->weight);
  torch::nn::init::zeros_(looks->bias);
  depth_->push_back(looks);

  context_ = Convolution(kFeatures, kContext, 1, 1);
  constexpr int kInputs = kContext + 8;
  motion_->push_back(Convolution(kInputs, 64, 3, 1));
  motion_->push_back(torch::nn::PReLU());
  motion_->push_back(Convolution(64, 96, 3, 2));
  motion_->push_back(torch::nn::PReLU());
  motion_->push_back(Convolution(96, kMotionFeatures, 3, 2));
  motion_->push_back(torch::nn::PReLU());
  motion_->push_back(torch::nn::AdaptiveAvgPool2d(
      torch::nn::AdaptiveAvgPool2dOptions({kPooledRows, kPooledColumns})));

  output_->push_back(torch::nn::Linear(kMotionFeatures * kPooledRows * kPooledColumns, 256));
  output_->push_back(torch::nn::PReLU());
  torch::nn::Linear last(256, 6);
  torch::nn::init::zeros_(last->weight);
  torch::nn::init::zeros_(last->bias);
  output_->push_back(last);

  register_module("branch", branch_);
  register_module("depth", depth_);
  register_module("context", context_);
  register_module("motion", motion_);
  register_module("output", output_);
  log_sharpness_ = register_parameter("log_sharpness", torch::full({1}, std::log(12.0)));
  if (covariance) {
    covariance_ = register_module(
        "covariance",
        std::make_shared<CovarianceHead>(kMotionFeatures * kPooledRows * kPooledColumns));
  }
}

Prediction CompactNetwork::forward(const torch::Tensor& live, const torch::Tensor& key) {
  Require(live.sizes() == key.sizes() && live.size(2) % 16 == 0 && live.size(3) % 16 == 0,
          "CompactNetwork", "images must have equal sizes divisible by 16");
  const std::int64_t batch = live.size(0);
  const torch::Tensor features = branch_->forward(torch::cat({live, key}));
  const torch::Tensor unit = torch::nn::functional::normalize(
      features.flatten(2), torch::nn::functional::NormalizeFuncOptions().dim(1));
  const torch::Tensor live_features = features.narrow(0, 0, batch);
  const Grid grid{features.size(2), features.size(3)};

  const torch::Tensor live_unit = unit.narrow(0, 0, batch) * log_sharpness_.exp();
  const torch::Tensor key_unit = unit.narrow(0, batch, batch);
  const Correlation correlation = Correlate(live_unit, key_unit, grid);
  const PeakFlow peak = ReadPeaks(correlation, grid);
  const torch::Tensor looks = depth_->forward(live_features);
  const torch::Tensor log_depth = looks.narrow(1, 0, 1) + kLogFirstDepth;
  const torch::Tensor trust = looks.narrow(1, 1, 1).sigmoid();
  const torch::Tensor share = peak.share.view({batch, 1, grid.rows, grid.columns});
  const torch::Tensor known_depth = log_depth.clamp(0, kMostLogDepth);

  Sightings sightings;
  const torch::Tensor rays = RayGrid(cells_).to(live.device());
  sightings.points = Grid3d(known_depth.squeeze(1).exp(), rays);
  sightings.seen =
      rays.slice(0, 0, 2).flatten(1) +
      peak.displacement / torch::tensor({cells_.fx, cells_.fy}, live.options()).view({2, 1});
  sightings.weight = (share * trust).flatten(1);
  const torch::Tensor solved = SolveMotion(sightings);

  const torch::Tensor flow = peak.displacement.view({batch, 2, grid.rows, grid.columns}) / 4.0;
  const torch::Tensor depth = known_depth.detach();
  const torch::Tensor head_input =
      torch::cat({flow * share, share, trust, (-depth).exp() * 10.0, depth / 4.0,
                  PlaceMap(grid, batch, live.options()), context_->forward(live_features)},
                 1);
  const torch::Tensor pooled = motion_->forward(head_input).flatten(1);
  const torch::Tensor raw = output_->forward(pooled);
  Prediction prediction;
  prediction.motion = Corrected(solved, raw);
  prediction.live_features = live_unit;
  prediction.key_features = key_unit;
  prediction.total = correlation.total;
  prediction.log_depth = log_depth.flatten(1);
  if (covariance_) {
    {
      const torch::NoGradGuard no_gradients;
      prediction.agreement = MotionFit(solved, sightings);
    }
    prediction.whitening = covariance_->forward(pooled, solved, sightings, prediction.agreement);
  }
  return prediction;
}

torch::Tensor Corrected(const torch::Tensor& solved, const torch::Tensor& raw) {
  // The head's outputs are of order one; a pair's rotation is of the order of 0.05 rad.
  constexpr double kRotationScale = 0.05;
  return Moved(solved, torch::cat({raw.slice(1, 0, 3) * kRotationScale, raw.slice(1, 3, 6)}, 1));
}

std::unique_ptr<PairEngine> CompactNetwork::MakeEngine(std::int64_t rows, std::int64_t columns,
                                                       Precision precision) {
  return std::make_unique<CompactEngine>(
      CompactParts{cells_, branch_, depth_, motion_, output_, context_, covariance_,
                   log_sharpness_.exp().item<float>()},
      Grid{rows / kCellPixels, columns / kCellPixels}, precision);
}

}  // namespace recollect::cnn
