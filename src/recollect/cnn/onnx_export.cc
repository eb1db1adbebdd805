#include "recollect/cnn/onnx_export.h"

#include <onnx/checker.h>
#include <onnx/onnx_pb.h>

#include <initializer_list>
#include <string>
#include <vector>

#include "recollect/cnn/layer_list.h"
#include "recollect/cnn/paper_network.h"
#include "recollect/core/error.h"
#include "recollect/core/files.h"

namespace recollect::cnn {
namespace {

constexpr int kOperatorSet = 11, kIrVersion = 6;

// A graph that is written from its inputs to its output.
class Writer {
 public:
  explicit Writer(onnx::GraphProto& graph) : graph_(graph) {}

  void Declare(onnx::ValueInfoProto& value, const std::string& name,
               std::initializer_list<std::int64_t> shape) {
    value.set_name(name);
    auto* type = value.mutable_type()->mutable_tensor_type();
    type->set_elem_type(onnx::TensorProto::FLOAT);
    for (const std::int64_t side : shape) type->mutable_shape()->add_dim()->set_dim_value(side);
  }

  void Constant(const std::string& name, const torch::Tensor& values) {
    const torch::Tensor plain = values.detach().to(torch::kCPU, torch::kFloat).contiguous();
    onnx::TensorProto* tensor = graph_.add_initializer();
    tensor->set_name(name);
    tensor->set_data_type(onnx::TensorProto::FLOAT);
    for (const std::int64_t side : plain.sizes()) tensor->add_dims(side);
    tensor->set_raw_data(plain.data_ptr(), plain.nbytes());
  }

  onnx::NodeProto& Node(const std::string& type, const std::vector<std::string>& inputs,
                        const std::string& output) {
    onnx::NodeProto& node = *graph_.add_node();
    node.set_op_type(type);
    node.set_name(output);
    for (const std::string& input : inputs) node.add_input(input);
    node.add_output(output);
    return node;
  }

  static void Set(onnx::NodeProto& node, const std::string& name,
                  std::initializer_list<std::int64_t> values) {
    onnx::AttributeProto& attribute = *node.add_attribute();
    attribute.set_name(name);
    attribute.set_type(onnx::AttributeProto::INTS);
    for (const std::int64_t value : values) attribute.add_ints(value);
  }
  static void Set(onnx::NodeProto& node, const std::string& name, std::int64_t value) {
    onnx::AttributeProto& attribute = *node.add_attribute();
    attribute.set_name(name);
    attribute.set_type(onnx::AttributeProto::INT);
    attribute.set_i(value);
  }
  static void Set(onnx::NodeProto& node, const std::string& name, float value) {
    onnx::AttributeProto& attribute = *node.add_attribute();
    attribute.set_name(name);
    attribute.set_type(onnx::AttributeProto::FLOAT);
    attribute.set_f(value);
  }

 private:
  onnx::GraphProto& graph_;
};

void AddConstants(Writer& writer, const std::vector<ListedLayer>& layers, const std::string& part) {
  for (std::size_t i = 0; i < layers.size(); ++i) {
    writer.Constant(fmt::format("{}.{}.weight", part, i), layers[i].weight);
    writer.Constant(fmt::format("{}.{}.bias", part, i), layers[i].bias);
  }
}

// The layers one after the other; the name of what comes out.
std::string AddLayers(Writer& writer, const std::vector<ListedLayer>& layers,
                      const std::string& part, const std::string& input) {
  std::string now = input;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const ListedLayer& layer = layers[i];
    const std::string name = fmt::format("{}.{}", part, i);
    onnx::NodeProto& node = writer.Node("Conv", {now, name + ".weight", name + ".bias"},
                                        fmt::format("{}.{}", input, name));
    Writer::Set(node, "kernel_shape", {layer.weight.size(2), layer.weight.size(3)});
    Writer::Set(node, "strides", {layer.stride, layer.stride});
    Writer::Set(node, "pads", {layer.padding, layer.padding, layer.padding, layer.padding});
    now = node.output(0);
    if (layer.slope == 1) continue;
    onnx::NodeProto& rectifier = writer.Node("LeakyRelu", {now}, now + ".rectified");
    Writer::Set(rectifier, "alpha", layer.slope);
    now = rectifier.output(0);
  }
  return now;
}

}  // namespace

void ExportOnnx(const PoseNetwork& network, const std::filesystem::path& file) {
  const auto paper = std::dynamic_pointer_cast<PaperNetwork>(network.network());
  Require(paper != nullptr, file.string(),
          fmt::format("network {} cannot be an ONNX file: the window around a correlation's peak "
                      "and the least squares behind it are no layers of ONNX runtimes",
                      Name(network.info().network)),
          "export a network a or b");
  onnx::ModelProto model;
  model.set_ir_version(kIrVersion);
  model.set_producer_name("recollect");
  model.add_opset_import()->set_version(kOperatorSet);
  onnx::GraphProto& graph = *model.mutable_graph();
  graph.set_name("relative_pose_" + Name(network.info().network));
  Writer writer(graph);
  const Crop& crop = network.crop();
  for (const char* image : {"live", "key"}) {
    writer.Declare(*graph.add_input(), image, {1, 3, crop.height, crop.width});
  }
  writer.Declare(*graph.add_output(), "delta", {1, 6});

  const std::vector<ListedLayer> branch = LayersOf(paper->branch()), top = LayersOf(paper->top());
  AddConstants(writer, branch, "branch");
  AddConstants(writer, top, "top");
  const std::string live = AddLayers(writer, branch, "branch", "live");
  const std::string key = AddLayers(writer, branch, "branch", "key");
  Writer::Set(writer.Node("Concat", {live, key}, "fused"), "axis", std::int64_t{1});
  const std::string out = AddLayers(writer, top, "top", "fused");
  Writer::Set(writer.Node("Flatten", {out}, "delta"), "axis", std::int64_t{1});
  try {
    onnx::checker::check_model(model);
  } catch (const std::exception& error) {
    throw Error(file.string(), fmt::format("would be no valid ONNX file ({})", error.what()));
  }
  AtomicWrite(file, model.SerializeAsString());
}

}  // namespace recollect::cnn
