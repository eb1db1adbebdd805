#include "recollect/cnn/layer_list.h"

namespace recollect::cnn {

std::vector<ListedLayer> LayersOf(const torch::nn::Sequential& sequence) {
  std::vector<ListedLayer> layers;
  for (const auto& module : *sequence) {
    if (const auto* conv = module.ptr()->as<torch::nn::Conv2d>()) {
      const auto padding = c10::get<torch::ExpandingArray<2>>(conv->options.padding());
      layers.push_back({conv->weight.detach(), conv->bias.detach(), 1,
                        conv->options.stride()->at(0), padding->at(0)});
    } else if (const auto* prelu = module.ptr()->as<torch::nn::PReLU>()) {
      layers.back().slope = prelu->weight.item<float>();
    }
  }
  return layers;
}

}  // namespace recollect::cnn
