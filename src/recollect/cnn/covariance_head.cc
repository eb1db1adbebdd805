#include "recollect/cnn/covariance_head.h"

#include <tuple>

namespace recollect::cnn {
namespace {

constexpr float kRadians = 0.01F, kMetres = 0.3F;  // the size of an error
constexpr int kHidden = 64;
constexpr int kNumbers = 21;  // of a triangular factor
constexpr int kFits = 3;      // of MotionFit
constexpr double kBound = 5;  // of the logarithms on the diagonal: e^-5 to e^5 times that size

}  // namespace

CovarianceHead::CovarianceHead(std::int64_t features)
    : units_(register_buffer(
          "units", torch::tensor({kRadians, kRadians, kRadians, kMetres, kMetres, kMetres}))) {
  const torch::Tensor places = torch::triu_indices(6, 6, 1);
  above_ = register_buffer("above", places[0] * 6 + places[1]);
  layers_->push_back(torch::nn::Linear(features + kNumbers + kFits, kHidden));
  layers_->push_back(torch::nn::PReLU());
  torch::nn::Linear last(kHidden, kNumbers);
  torch::nn::init::zeros_(last->weight);
  torch::nn::init::zeros_(last->bias);
  layers_->push_back(last);
  register_module("layers", layers_);
}

torch::Tensor CovarianceHead::forward(const torch::Tensor& features, const torch::Tensor& solved,
                                      const Sightings& sightings, const torch::Tensor& agreement) {
  torch::Tensor input;
  {
    // The factor of what least squares says, in the form in which the layers give theirs.
    const torch::NoGradGuard no_gradients;
    const torch::Tensor precision =
        MotionPrecision(solved, sightings) * units_ * units_.unsqueeze(1);
    const torch::Tensor factor =
        std::get<0>(torch::linalg_cholesky_ex(precision.to(torch::kDouble))).transpose(1, 2);
    const torch::Tensor diagonal = factor.diagonal(0, 1, 2);
    const torch::Tensor rows = (factor / diagonal.unsqueeze(2)).flatten(1).index_select(1, above_);
    const torch::Tensor numbers =
        torch::cat({diagonal.log(), rows, agreement.to(torch::kDouble)}, 1)
            .clamp(-kBound, kBound)
            .to(features.scalar_type());
    input = torch::cat({features, numbers}, 1);
  }
  const torch::Tensor raw = layers_->forward(input);
  const torch::Tensor diagonal = raw.slice(1, 0, 6).clamp(-kBound, kBound).exp();
  const torch::Tensor rows = torch::zeros({raw.size(0), 36}, raw.options())
                                 .index_copy(1, above_, raw.slice(1, 6))
                                 .view({-1, 6, 6}) +
                             torch::eye(6, raw.options());
  return diagonal.unsqueeze(2) * rows / units_;
}

}  // namespace recollect::cnn
