#include <fmt/format.h>

#include <memory>

#include "command.h"
#include "commands.h"
#include "recollect/cnn/onnx_export.h"

namespace recollect::app {
namespace {

struct ExportFlags {
  Common common;
  std::filesystem::path model, onnx;
};

void RunExport(const ExportFlags& flags) {
  const cnn::PoseNetwork network = cnn::PoseNetwork::Load(flags.model, flags.common.threads);
  cnn::ExportOnnx(network, flags.onnx);
  fmt::print(
      "{}: live and key [1, 3, {}, {}], R, G, B from 0 to 1 -> delta [1, 6], rotation vector and "
      "translation of the live camera in the key frame's\n",
      flags.onnx.string(), network.crop().height, network.crop().width);
}

}  // namespace

void AddModel(CLI::App& app) {
  CLI::App* model = app.add_subcommand("model", "What to do with a trained network");
  model->require_subcommand(1);
  auto flags = std::make_shared<ExportFlags>();
  CLI::App* command = AddCommand(*model, "export", "Write a network for other programs",
                                 flags->common, [flags] { RunExport(*flags); });
  command->add_option("model", flags->model, "the model file")->required();
  command->add_option("--onnx", flags->onnx, "the ONNX file to write")->required();
}

}  // namespace recollect::app
