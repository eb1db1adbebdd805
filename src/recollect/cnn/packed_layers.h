#pragma once

#include <torch/torch.h>

#include <cstdint>
#include <map>
#include <oneapi/dnnl/dnnl.hpp>
#include <vector>

#include "recollect/cnn/precision.h"

// oneDNN's layers with weights put in its own order once, when they are made. Not for several
// threads at once: each keeps the memory its results are in.
namespace recollect::cnn {

const dnnl::engine& OnednnEngine();
dnnl::stream& OnednnStream();  // of this thread

dnnl::memory::data_type DataType(Precision precision);

// `values` [...] of 32-bit floats in row order, as memory of the given type.
dnnl::memory ToOnednn(const torch::Tensor& values, dnnl::memory::data_type type);

// Puts values into another order or type; done when this stream's earlier work and this are.
void Copy(const dnnl::memory& from, const dnnl::memory& to);

// What follows a layer: y = x or slope * x for negative x. 1: nothing.
dnnl::primitive_attr Rectified(float slope);

class PackedConvolution {
 public:
  // The order of the result's values: oneDNN's own, or channels last and 32-bit floats.
  enum class Result { kPacked, kChannelsLast };

  // weight [O, I, h, w], bias [O].
  PackedConvolution(const torch::Tensor& weight, const torch::Tensor& bias, float slope,
                    std::int64_t stride, std::int64_t padding, Precision precision,
                    Result result = Result::kPacked);

  // source [N, I, H, W] in any order; the result lives until the next call.
  const dnnl::memory& Run(const dnnl::memory& source);

 private:
  struct Ready {
    dnnl::convolution_forward::primitive_desc description;
    dnnl::convolution_forward primitive;
    dnnl::memory result;
  };
  Ready Prepare(const dnnl::memory::desc& source);

  dnnl::memory::dims weight_dims_;
  std::int64_t stride_, padding_;
  Result result_;
  dnnl::memory::data_type type_;
  dnnl::primitive_attr attributes_;
  torch::Tensor plain_weight_, plain_bias_;  // let go once packed
  dnnl::memory weight_, bias_;
  std::map<dnnl::memory::dims, Ready> ready_;  // by the source's shape
};

}  // namespace recollect::cnn
