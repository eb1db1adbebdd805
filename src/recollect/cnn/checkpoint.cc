#include "recollect/cnn/checkpoint.h"

#include <nlohmann/json.hpp>

#include "recollect/cnn/tensor_file.h"
#include "recollect/core/error.h"
#include "recollect/core/files.h"

namespace recollect::cnn {

namespace {

constexpr const char* kAverage = "average.";  // what names of averaged weights begin with

}  // namespace

// Checkpoints of earlier versions know nothing of likelihoods.
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(CurvePoint, step, epoch, seconds, learning_rate,
                                                loss, projection_m, correspondence, depth,
                                                likelihood, train_position_m, valid_position_m,
                                                valid_heading_deg)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TrainingState, step, seconds_before, best_m, without_gain, curve,
                                   skipped, sums, sum_steps, options)

void WriteCheckpoint(const std::filesystem::path& path, const TrainingState& state,
                     const torch::nn::Module& network, const Adam& adam,
                     const torch::nn::Module* average) {
  TensorFile file;
  file.header["checkpoint"] = state;
  for (const auto& parameter : network.named_parameters()) {
    file.tensors.emplace_back(parameter.key(), parameter.value());
  }
  for (const auto& tensor : adam.State()) file.tensors.push_back(tensor);
  if (average != nullptr) {
    for (const auto& parameter : average->named_parameters()) {
      file.tensors.emplace_back(kAverage + parameter.key(), parameter.value());
    }
  }
  WriteTensorFile(path, file);
}

TrainingState ReadCheckpoint(const std::filesystem::path& path, const std::string& options,
                             torch::nn::Module& network, Adam& adam, torch::nn::Module* average) {
  const TensorFile file = ReadTensorFile(path);
  const std::string where = path.string();
  Require(file.header.contains("checkpoint"), where, "is not a checkpoint");
  TrainingState state;
  try {
    file.header["checkpoint"].get_to(state);
  } catch (const nlohmann::json::exception& error) {
    throw Error(where, fmt::format("has a broken header ({})", error.what()));
  }
  Require(state.options == options, where, "was made with other options",
          "repeat them, or remove it to begin anew");
  const torch::NoGradGuard no_gradients;
  for (auto& parameter : network.named_parameters()) {
    parameter.value().copy_(file.Find(parameter.key(), parameter.value(), where));
  }
  if (average != nullptr) {
    for (auto& parameter : average->named_parameters()) {
      parameter.value().copy_(file.Find(kAverage + parameter.key(), parameter.value(), where));
    }
  }
  adam.Restore(file, state.step - state.skipped, where);
  return state;
}

void WriteCurve(const std::filesystem::path& path, const std::vector<CurvePoint>& curve) {
  if (path.empty()) return;
  std::string text =
      "step,epoch,seconds,learning_rate,loss,projection_m,correspondence,depth,"
      "valid_position_m,valid_heading_deg,train_position_m,likelihood\n";
  for (const CurvePoint& p : curve) {
    text += fmt::format(
        "{},{:.4f},{:.1f},{:.3e},{:.5f},{:.5f},{:.5f},{:.5f},{:.5f},{:.5f},{:.5f},{:.5f}\n", p.step,
        p.epoch, p.seconds, p.learning_rate, p.loss, p.projection_m, p.correspondence, p.depth,
        p.valid_position_m, p.valid_heading_deg, p.train_position_m, p.likelihood);
  }
  AtomicWrite(path, text);
}

}  // namespace recollect::cnn
