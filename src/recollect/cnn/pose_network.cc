#include "recollect/cnn/pose_network.h"

#include <torch/torch.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "recollect/cnn/loader.h"
#include "recollect/cnn/pair_network.h"
#include "recollect/cnn/tensor_file.h"
#include "recollect/cnn/threads.h"
#include "recollect/core/error.h"

namespace recollect::cnn {
namespace {

constexpr std::size_t kBatch = 16;  // pairs that go through the network together

void RequireCrop(const cv::Mat& image, const Crop& crop) {
  Require(image.type() == CV_8UC3 && image.cols == crop.width && image.rows == crop.height,
          "PoseNetwork",
          fmt::format("a crop of {} x {} pixels where {} x {} in colour belong", image.cols,
                      image.rows, crop.width, crop.height));
}

TensorFile ReadModel(const std::filesystem::path& path) {
  TensorFile file = ReadTensorFile(path);
  Require(file.header.contains("model"), path.string(), "is not a model (a checkpoint?)",
          "give the file that 'recollect train --out' wrote");
  return file;
}

void CopyWeights(const TensorFile& file, const std::string& where, PairNetwork& network) {
  const torch::NoGradGuard no_gradients;
  for (auto& parameter : network.named_parameters()) {
    parameter.value().copy_(file.Find(parameter.key(), parameter.value(), where));
  }
}

}  // namespace

PoseNetwork::PoseNetwork(ModelInfo info, std::shared_ptr<PairNetwork> network)
    : info_(std::move(info)), network_(std::move(network)) {
  network_->eval();
}

PoseNetwork PoseNetwork::Load(const std::filesystem::path& path, int threads) {
  SetThreads(threads);
  const TensorFile file = ReadModel(path);
  const ModelInfo info = ModelInfoFromJson(file.header["model"].dump(), path.string());
  auto network = MakeNetwork(info.network, info.camera);
  CopyWeights(file, path.string(), *network);
  return {info, network};
}

void CopyWeights(const std::filesystem::path& model, NetworkKind kind, PairNetwork& network) {
  const TensorFile file = ReadModel(model);
  const ModelInfo info = ModelInfoFromJson(file.header["model"].dump(), model.string());
  Require(info.network == kind, model.string(),
          fmt::format("is a network {} where {} is trained", Name(info.network), Name(kind)));
  CopyWeights(file, model.string(), network);
}

PoseNetwork PoseNetwork::Untrained(int image_width, int image_height) {
  ModelInfo info;
  info.network = NetworkKind::kPaperB;
  info.crop = DefaultCrop(info.network, image_width, image_height);
  return {info, MakeNetwork(info.network, info.camera)};
}

void PoseNetwork::Save(const std::filesystem::path& path) const {
  TensorFile file;
  file.header["model"] = nlohmann::json::parse(ToJson(info_));
  for (const auto& parameter : network_->named_parameters()) {
    file.tensors.emplace_back(parameter.key(), parameter.value());
  }
  WriteTensorFile(path, file);
}

SE3 PoseNetwork::KeyframeFromLive(const cv::Mat& live_crop, const cv::Mat& key_crop) const {
  const CropPair pair{live_crop, key_crop};
  return KeyframeFromLive(std::span(&pair, 1)).front();
}

std::vector<SE3> PoseNetwork::KeyframeFromLive(std::span<const CropPair> pairs) const {
  const torch::InferenceMode inference;
  std::vector<SE3> motions;
  motions.reserve(pairs.size());
  for (std::size_t from = 0; from < pairs.size(); from += kBatch) {
    std::vector<torch::Tensor> live, key;
    for (const CropPair& pair : pairs.subspan(from, std::min(kBatch, pairs.size() - from))) {
      RequireCrop(pair.live, info_.crop);
      RequireCrop(pair.key, info_.crop);
      live.push_back(PrepareImage(info_.network, pair.live));
      key.push_back(PrepareImage(info_.network, pair.key));
    }
    const torch::Tensor out =
        network_->forward(torch::stack(live), torch::stack(key)).motion.contiguous();
    for (std::int64_t i = 0; i < out.size(0); ++i) {
      using Rows = Eigen::Matrix<float, 3, 4, Eigen::RowMajor>;
      const Eigen::Matrix<double, 3, 4> motion =
          Eigen::Map<const Rows>(out.data_ptr<float>() + 12 * i).cast<double>();
      motions.emplace_back(NearestRotation(motion.leftCols<3>()), motion.col(3));
    }
  }
  return motions;
}

}  // namespace recollect::cnn
