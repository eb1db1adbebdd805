#include "recollect/cnn/fast_layers.h"

#include <ATen/Parallel.h>

#include <array>
#include <atomic>
#include <oneapi/dnnl/dnnl.hpp>
#include <vector>

#include "recollect/cnn/convolution_taps.h"
#include "recollect/cnn/elementwise.h"

namespace recollect::cnn {
namespace {

using torch::autograd::AutogradContext;
using torch::autograd::variable_list;

constexpr std::int64_t kGrain = 1 << 15;
constexpr float kLeastSlope = 1e-3F;  // below, what went in cannot be told from what came out

bool IsHalf(const torch::Tensor& x) { return x.scalar_type() == torch::kBFloat16; }

std::uint16_t* Bits(const torch::Tensor& x) {
  return reinterpret_cast<std::uint16_t*>(x.data_ptr<at::BFloat16>());
}

class RectifyFunction : public torch::autograd::Function<RectifyFunction> {
 public:
  static torch::Tensor forward(AutogradContext* context, torch::Tensor x,
                               const torch::Tensor& slope) {
    const auto factor = slope.item<float>();
    at::parallel_for(0, x.numel(), kGrain, [&](std::int64_t begin, std::int64_t end) {
      if (IsHalf(x)) {
        RectifyBfloat16(Bits(x) + begin, end - begin, factor);
      } else {
        Rectify(x.data_ptr<float>() + begin, end - begin, factor);
      }
    });
    context->mark_dirty({x});
    context->save_for_backward({x, slope});
    return x;
  }

  static variable_list backward(AutogradContext* context, const variable_list& gradients) {
    const auto saved = context->get_saved_variables();
    const torch::Tensor &y = saved[0], &slope = saved[1];
    // Of y's own order, so that both can be walked through as they lie.
    const torch::Tensor gradient = gradients[0].contiguous(y.suggest_memory_format());
    torch::Tensor out = torch::empty_like(y);
    const auto factor = slope.item<float>();
    // Partial sums by place, so that the result does not depend on who came first.
    constexpr std::int64_t kPart = 1 << 18;
    std::vector<double> sums(static_cast<std::size_t>((y.numel() + kPart - 1) / kPart));
    at::parallel_for(
        0, static_cast<std::int64_t>(sums.size()), 1, [&](std::int64_t begin, std::int64_t end) {
          for (std::int64_t i = begin; i < end; ++i) {
            const std::int64_t from = i * kPart;
            const std::int64_t count = std::min(kPart, y.numel() - from);
            sums[static_cast<std::size_t>(i)] =
                IsHalf(y)
                    ? RectifyBackwardBfloat16(Bits(y) + from, Bits(gradient) + from,
                                              Bits(out) + from, count, factor)
                    : RectifyBackward(y.data_ptr<float>() + from, gradient.data_ptr<float>() + from,
                                      out.data_ptr<float>() + from, count, factor);
          }
        });
    double sum = 0;
    for (const double part : sums) sum += part;
    return {out, torch::full_like(slope, sum / factor)};
  }
};

bool Walkable(const torch::Tensor& x) {
  return x.is_cpu() && (x.scalar_type() == torch::kFloat || IsHalf(x)) && x.dim() == 4 &&
         x.is_contiguous(x.suggest_memory_format());
}

// The columns of a weight [O, I, h, w], kept channels-last, that some taps make: [O, taps I] within
// rows of h w I.
struct Matrix {
  float* first;
  std::int64_t rows, columns, row_length;
};

Matrix Columns(const torch::Tensor& weight, std::int64_t first_tap, std::int64_t taps) {
  const std::int64_t inputs = weight.size(1);
  return {weight.data_ptr<float>() + first_tap * inputs, weight.size(0), taps * inputs,
          weight[0].numel()};
}

class ProductFunction : public torch::autograd::Function<ProductFunction> {
 public:
  // x [R, taps I], weight [O, I, h, w] channels-last, bias [O] -> [R, O].
  static torch::Tensor forward(AutogradContext* context, const torch::Tensor& x,
                               const torch::Tensor& weight, const torch::Tensor& bias,
                               std::int64_t first_tap, std::int64_t taps) {
    context->save_for_backward({x, weight});
    context->saved_data["first"] = first_tap;
    context->saved_data["taps"] = taps;
    const Matrix w = Columns(weight, first_tap, taps);
    torch::Tensor out = bias.unsqueeze(0).repeat({x.size(0), 1});
    dnnl::sgemm('N', 'T', x.size(0), w.rows, w.columns, 1, x.data_ptr<float>(), w.columns, w.first,
                w.row_length, 1, out.data_ptr<float>(), w.rows);
    return out;
  }

  static variable_list backward(AutogradContext* context, const variable_list& gradients) {
    const auto saved = context->get_saved_variables();
    const torch::Tensor &x = saved[0], &weight = saved[1];
    const torch::Tensor gradient = gradients[0].contiguous();
    const std::int64_t first = context->saved_data["first"].toInt();
    const std::int64_t taps = context->saved_data["taps"].toInt(), all = weight[0].numel();
    const Matrix w = Columns(weight, first, taps);
    torch::Tensor x_gradient = torch::empty_like(x);
    dnnl::sgemm('N', 'N', x.size(0), w.columns, w.rows, 1, gradient.data_ptr<float>(), w.rows,
                w.first, w.row_length, 0, x_gradient.data_ptr<float>(), w.columns);
    torch::Tensor weight_gradient = torch::empty_like(weight);
    const Matrix out = Columns(weight_gradient, first, taps);
    if (w.columns < all) weight_gradient.zero_();
    dnnl::sgemm('T', 'N', w.rows, w.columns, x.size(0), 1, gradient.data_ptr<float>(), w.rows,
                x.data_ptr<float>(), w.columns, 0, out.first, out.row_length);
    return {x_gradient, weight_gradient, gradient.sum(0), {}, {}};
  }
};

}  // namespace

torch::Tensor Convolve(const torch::Tensor& x, const torch::nn::Conv2dImpl& layer) {
  return torch::conv2d(x, layer.weight.to(x.scalar_type()), layer.bias.to(x.scalar_type()),
                       layer.options.stride(),
                       c10::get<torch::ExpandingArray<2>>(layer.options.padding()));
}

torch::Tensor RectifyInPlace(const torch::Tensor& x, const torch::Tensor& slope) {
  if (!Walkable(x) || slope.numel() != 1 || slope.item<float>() < kLeastSlope) {
    return torch::prelu(x, slope);
  }
  return RectifyFunction::apply(x, slope);
}

torch::Tensor ConvolveAsProduct(const torch::Tensor& x, const torch::nn::Conv2dImpl& layer) {
  const torch::Tensor& weight = layer.weight;
  const auto stride = layer.options.stride();
  const auto padding = c10::get<torch::ExpandingArray<2>>(layer.options.padding());
  const bool square = stride->at(0) == stride->at(1) && padding->at(0) == padding->at(1);
  if (!x.is_cpu() || x.scalar_type() != torch::kFloat || !square ||
      !weight.is_contiguous(torch::MemoryFormat::ChannelsLast)) {
    return torch::conv2d(x, weight, layer.bias, stride, padding);
  }
  const ConvolutionTaps taps = ConvolutionTaps::Of(x.size(2), x.size(3), weight.size(2),
                                                   weight.size(3), stride->at(0), padding->at(0));
  const std::int64_t batch = x.size(0), inputs = x.size(1), outputs = weight.size(0);
  const torch::Tensor cells = x.flatten(2).transpose(1, 2);  // [B, H W, I]
  const torch::Tensor padded = torch::cat({cells, torch::zeros({batch, 1, inputs})}, 1);
  const torch::Tensor rows = padded.index_select(1, torch::tensor(taps.sources));
  const auto seeing = static_cast<std::int64_t>(taps.outputs.size());
  torch::Tensor y = ProductFunction::apply(rows.reshape({batch * seeing, taps.taps * inputs}),
                                           weight, layer.bias, taps.first_tap, taps.taps)
                        .view({batch, seeing, outputs});
  if (seeing < taps.rows * taps.columns) {  // the others are the bias
    std::vector<std::int64_t> place(static_cast<std::size_t>(taps.rows * taps.columns), seeing);
    for (std::int64_t i = 0; i < seeing; ++i) {
      place[static_cast<std::size_t>(taps.outputs[static_cast<std::size_t>(i)])] = i;
    }
    y = torch::cat({y, layer.bias.expand({batch, 1, outputs})}, 1)
            .index_select(1, torch::tensor(place));
  }
  return y.view({batch, taps.rows, taps.columns, outputs}).permute({0, 3, 1, 2});
}

}  // namespace recollect::cnn
