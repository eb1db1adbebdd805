#include "recollect/cnn/paper_engine.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "recollect/cnn/layer_list.h"
#include "recollect/cnn/layers.h"
#include "recollect/core/error.h"

namespace recollect::cnn {
namespace {

using dnnl::memory;

constexpr std::size_t kWide = 3;  // layers done as products, before the output layer

PackedConvolution Packed(const ListedLayer& layer, Precision precision) {
  return {layer.weight, layer.bias, layer.slope, layer.stride, layer.padding, precision};
}

// [O, I, h, w] -> [O, h w, I].
torch::Tensor ByTaps(const torch::Tensor& weight) { return weight.flatten(2).transpose(1, 2); }

memory Reordered(const memory& from, const memory::desc& to) {
  memory out(to, OnednnEngine());
  Copy(from, out);
  return out;
}

// The order of `features`' channels, for a memory of another shape.
memory::format_tag OrderOf(const memory::desc& features) {
  for (const auto tag : {memory::format_tag::nChw16c, memory::format_tag::nChw8c}) {
    if (features == memory::desc(features.dims(), features.data_type(), tag)) return tag;
  }
  return memory::format_tag::nhwc;
}

}  // namespace

PaperEngine::PaperEngine(torch::nn::Sequential branch, torch::nn::Sequential top,
                         std::int64_t image_rows, std::int64_t image_columns, Precision precision)
    : type_(DataType(precision)) {
  std::int64_t rows = image_rows, columns = image_columns;
  const auto taps_of = [&](const ListedLayer& layer) {
    const ConvolutionTaps taps = ConvolutionTaps::Of(
        rows, columns, layer.weight.size(2), layer.weight.size(3), layer.stride, layer.padding);
    rows = taps.rows;
    columns = taps.columns;
    return taps;
  };
  for (const ListedLayer& layer : LayersOf(branch)) {
    branch_.push_back(Packed(layer, precision));
    taps_of(layer);
  }
  const std::vector<ListedLayer> tops = LayersOf(top);
  const std::size_t plain = tops.size() - kWide - 1;
  for (std::size_t i = 0; i < plain; ++i) {
    top_.push_back(Packed(tops[i], precision));
    taps_of(tops[i]);
  }
  for (std::size_t i = plain; i < plain + kWide; ++i) {
    const ListedLayer& layer = tops[i];
    const ConvolutionTaps taps = taps_of(layer);
    const torch::Tensor weight = ByTaps(layer.weight).narrow(1, taps.first_tap, taps.taps);
    const torch::Tensor rows = weight.flatten(1);
    wide_.push_back({taps, FixedProduct(rows, layer.bias, layer.slope)});
  }
  for (const Wide& layer : std::span(wide_).first(kWide - 1)) {
    Require(static_cast<std::int64_t>(layer.taps.outputs.size()) ==
                layer.taps.rows * layer.taps.columns,
            "PaperEngine", "images of this size leave the network's last layers nothing to see");
  }

  // Outputs of the last product that see padding only are constants.
  const ListedLayer &before = tops[plain + kWide - 1], &last = tops.back();
  Require(last.weight.size(2) == rows && last.weight.size(3) == columns, "PaperEngine",
          "images of this size do not come down to one cell");
  const torch::Tensor constant =
      torch::where(before.bias > 0, before.bias, before.bias * before.slope);
  const torch::Tensor weight = ByTaps(last.weight);  // [6, cells, 4096]
  const auto seeing = torch::tensor(wide_.back().taps.outputs);
  last_weight_ = weight.index_select(1, seeing).flatten(1).t().contiguous();
  last_bias_ =
      last.bias + torch::matmul(weight.sum(1) - weight.index_select(1, seeing).sum(1), constant);
}

memory PaperEngine::Fuse(const memory& features, std::span<const ImagePair> pairs) const {
  const memory::desc from = features.get_desc();
  const memory::dims d = from.dims();
  const auto batch = static_cast<std::int64_t>(pairs.size());
  const memory::desc to({batch, 2 * d[1], d[2], d[3]}, type_, OrderOf(from));
  memory fused(to, OnednnEngine());
  const memory::dims one = {1, d[1], d[2], d[3]};
  for (std::int64_t i = 0; i < batch; ++i) {
    const ImagePair& pair = pairs[static_cast<std::size_t>(i)];
    for (const auto& [image, channel] : {std::pair{pair.live, std::int64_t{0}}, {pair.key, d[1]}}) {
      const memory source(from.submemory_desc(one, {image, 0, 0, 0}), OnednnEngine(),
                          features.get_data_handle());
      const memory target(to.submemory_desc(one, {i, channel, 0, 0}), OnednnEngine(),
                          fused.get_data_handle());
      Copy(source, target);
    }
  }
  return fused;
}

torch::Tensor PaperEngine::Wide::Run(const torch::Tensor& cells) const {
  const std::int64_t batch = cells.size(0), channels = cells.size(2);
  const std::int64_t outside = cells.size(1);  // ConvolutionTaps::sources
  const auto outputs = static_cast<std::int64_t>(taps.outputs.size());
  const torch::Tensor rows = torch::empty({batch * outputs, taps.taps * channels});
  auto* to = rows.data_ptr<float>();
  for (std::int64_t i = 0; i < batch; ++i) {
    const auto* image = cells.data_ptr<float>() + i * outside * channels;
    for (const std::int64_t source : taps.sources) {
      to = source == outside ? std::fill_n(to, channels, 0.F)
                             : std::copy_n(image + source * channels, channels, to);
    }
  }
  return product.Run(rows).view({batch, outputs, -1});
}

PairAnswers PaperEngine::Answer(const torch::Tensor& images, std::span<const ImagePair> pairs) {
  const std::lock_guard lock(mutex_);
  const auto batch = static_cast<std::int64_t>(pairs.size());
  memory now = ToOnednn(images, type_);
  if (type_ == memory::data_type::bf16) {  // the order that matrix units (AMX) want
    now = Reordered(now, {now.get_desc().dims(), type_, memory::format_tag::nhwc});
  }
  for (PackedConvolution& layer : branch_) now = layer.Run(now);
  now = Fuse(now, pairs);
  for (PackedConvolution& layer : top_) now = layer.Run(now);
  const memory::dims d = now.get_desc().dims();
  const memory nhwc = Reordered(now, {d, memory::data_type::f32, memory::format_tag::nhwc});
  OnednnStream().wait();
  torch::Tensor cells = torch::from_blob(nhwc.get_data_handle(), {batch, d[2] * d[3], d[1]});
  for (const Wide& layer : wide_) cells = layer.Run(cells);
  return {Se3Layer(torch::addmm(last_bias_, cells.flatten(1), last_weight_)), {}, {}};
}

}  // namespace recollect::cnn
