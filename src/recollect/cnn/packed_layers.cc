#include "recollect/cnn/packed_layers.h"

#include <utility>

namespace recollect::cnn {

using dnnl::memory;

namespace {

constexpr std::size_t kShapes = 8;  // of sources, that a layer keeps ready

memory Reordered(const memory& from, const memory::desc& to) {
  memory out(to, OnednnEngine());
  Copy(from, out);
  OnednnStream().wait();
  return out;
}

}  // namespace

const dnnl::engine& OnednnEngine() {
  static const dnnl::engine engine(dnnl::engine::kind::cpu, 0);
  return engine;
}

dnnl::stream& OnednnStream() {
  thread_local dnnl::stream stream(OnednnEngine());
  return stream;
}

memory::data_type DataType(Precision precision) {
  return precision == Precision::kBfloat16 ? memory::data_type::bf16 : memory::data_type::f32;
}

memory ToOnednn(const torch::Tensor& values, memory::data_type type) {
  const torch::Tensor plain = values.detach().to(torch::kFloat).contiguous();
  memory::dims strides = plain.strides().vec();
  const memory::desc from(plain.sizes().vec(), memory::data_type::f32, strides);
  const memory::desc to(plain.sizes().vec(), type, strides);
  return Reordered(memory(from, OnednnEngine(), plain.data_ptr()), to);
}

void Copy(const memory& from, const memory& to) {
  dnnl::reorder(from, to).execute(OnednnStream(), {{DNNL_ARG_FROM, from}, {DNNL_ARG_TO, to}});
}

dnnl::primitive_attr Rectified(float slope) {
  dnnl::primitive_attr attributes;
  if (slope == 1.F) return attributes;
  dnnl::post_ops after;
  after.append_eltwise(1.F, dnnl::algorithm::eltwise_relu, slope, 0.F);
  attributes.set_post_ops(after);
  return attributes;
}

PackedConvolution::PackedConvolution(const torch::Tensor& weight, const torch::Tensor& bias,
                                     float slope, std::int64_t stride, std::int64_t padding,
                                     Precision precision, Result result)
    : weight_dims_(weight.sizes().vec()),
      stride_(stride),
      padding_(padding),
      result_(result),
      type_(DataType(precision)),
      attributes_(Rectified(slope)),
      plain_weight_(weight),
      bias_(ToOnednn(bias, memory::data_type::f32)) {}

PackedConvolution::Ready PackedConvolution::Prepare(const memory::desc& source) {
  const memory::dims in = source.dims();
  const auto side = [&](std::size_t i) {
    return (in[i] + 2 * padding_ - weight_dims_[i]) / stride_ + 1;
  };
  const memory::dims dims = {in[0], weight_dims_[0], side(2), side(3)};
  const memory::desc out =
      result_ == Result::kPacked
          ? memory::desc(dims, type_, memory::format_tag::any)
          : memory::desc(dims, memory::data_type::f32, memory::format_tag::nhwc);
  const memory::dims strides = {stride_, stride_}, padding = {padding_, padding_};
  const auto describe = [&](const memory::desc& weights) {
    return dnnl::convolution_forward::primitive_desc(
        {dnnl::prop_kind::forward_inference, dnnl::algorithm::convolution_direct, source, weights,
         bias_.get_desc(), out, strides, padding, padding},
        attributes_, OnednnEngine());
  };
  if (plain_weight_.defined()) {
    const auto any =
        describe(memory::desc(weight_dims_, type_, memory::format_tag::any)).weights_desc();
    weight_ = Reordered(ToOnednn(plain_weight_, memory::data_type::f32), any);
    plain_weight_.reset();
  }
  const auto description = describe(weight_.get_desc());
  return {description, dnnl::convolution_forward(description),
          memory(description.dst_desc(), OnednnEngine())};
}

const memory& PackedConvolution::Run(const memory& source) {
  const memory::desc shape = source.get_desc();
  auto found = ready_.find(shape.dims());
  if (found == ready_.end()) {
    if (ready_.size() >= kShapes) ready_.clear();
    found = ready_.emplace(shape.dims(), Prepare(shape)).first;
  }
  Ready& ready = found->second;
  ready.primitive.execute(OnednnStream(), {{DNNL_ARG_SRC, source},
                                           {DNNL_ARG_WEIGHTS, weight_},
                                           {DNNL_ARG_BIAS, bias_},
                                           {DNNL_ARG_DST, ready.result}});
  return ready.result;
}

}  // namespace recollect::cnn
