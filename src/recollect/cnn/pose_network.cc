#include "recollect/cnn/pose_network.h"

#include <ATen/Parallel.h>
#include <torch/torch.h>

#include <algorithm>
#include <map>
#include <mutex>
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

void CopyWeights(const TensorFile& file, const ModelInfo& info, const std::string& where,
                 PairNetwork& network) {
  const torch::NoGradGuard no_gradients;
  for (auto& parameter : network.named_parameters()) {
    if (!info.covariance && parameter.key().starts_with(kCovarianceWeights)) continue;
    parameter.value().copy_(file.Find(parameter.key(), parameter.value(), where));
  }
}

// Images as the network takes them, each once, and who is paired with whom.
struct Prepared {
  torch::Tensor images;  // [images, 3, H, W]
  std::vector<ImagePair> pairs;
};

Prepared Prepare(const ModelInfo& info, std::span<const CropPair> pairs) {
  Prepared prepared;
  std::vector<const cv::Mat*> images;
  std::map<std::pair<const void*, std::size_t>, std::int64_t> known;
  const auto number = [&](const cv::Mat& image) {
    RequireCrop(image, info.crop);
    const auto [found, fresh] =
        known.try_emplace({image.data, image.step}, static_cast<std::int64_t>(images.size()));
    if (fresh) images.push_back(&image);
    return found->second;
  };
  for (const CropPair& pair : pairs) {
    const std::int64_t live = number(pair.live);
    prepared.pairs.push_back({live, number(pair.key)});
  }
  const auto count = static_cast<std::int64_t>(images.size());
  prepared.images = torch::empty({count, 3, info.crop.height, info.crop.width});
  float* to = prepared.images.data_ptr<float>();
  const std::int64_t size = prepared.images.numel() / std::max<std::int64_t>(1, count);
  at::parallel_for(0, count, 1, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      PrepareImage(info.network, *images[static_cast<std::size_t>(i)], to + i * size);
    }
  });
  return prepared;
}

PairAnswers Forward(PairNetwork& network, const Prepared& prepared) {
  const torch::Device device = network.parameters().front().device();
  std::vector<torch::Tensor> live, key;
  for (const ImagePair& pair : prepared.pairs) {
    live.push_back(prepared.images[pair.live]);
    key.push_back(prepared.images[pair.key]);
  }
  const Prediction said =
      network.forward(torch::stack(live).to(device), torch::stack(key).to(device));
  if (!said.whitening.defined()) return {said.motion.cpu(), {}, {}};
  return {said.motion.cpu(), said.whitening.cpu(), said.agreement.cpu()};
}

SE3 MotionAt(const torch::Tensor& motions, std::int64_t i) {
  using Rows = Eigen::Matrix<float, 3, 4, Eigen::RowMajor>;
  const Eigen::Matrix<double, 3, 4> motion =
      Eigen::Map<const Rows>(motions.data_ptr<float>() + 12 * i).cast<double>();
  return {NearestRotation(motion.leftCols<3>()), motion.col(3)};
}

Matrix6d CovarianceAt(const torch::Tensor& whitenings, std::int64_t i) {
  using Rows = Eigen::Matrix<float, 6, 6, Eigen::RowMajor>;
  const Matrix6d whitening =
      Eigen::Map<const Rows>(whitenings.data_ptr<float>() + 36 * i).cast<double>();
  const Matrix6d root = whitening.triangularView<Eigen::Upper>().solve(Matrix6d::Identity());
  return root * root.transpose();
}

}  // namespace

// Made at the first question, and shared by copies.
struct PoseNetwork::Engine {
  Precision precision;
  std::once_flag asked;
  std::unique_ptr<PairEngine> engine;

  PairEngine* Get(PairNetwork& network, const Crop& crop) {
    std::call_once(asked, [&] {
      if (!network.parameters().front().device().is_cpu()) return;
      engine = network.MakeEngine(crop.height, crop.width, precision);
    });
    return engine.get();
  }
};

PoseNetwork::PoseNetwork(ModelInfo info, std::shared_ptr<PairNetwork> network, Precision precision)
    : info_(std::move(info)),
      network_(std::move(network)),
      engine_(std::make_shared<Engine>(precision)) {
  network_->eval();
}

PoseNetwork PoseNetwork::Load(const std::filesystem::path& path, int threads, Precision precision) {
  SetThreads(threads);
  const TensorFile file = ReadModel(path);
  const ModelInfo info = ModelInfoFromJson(file.header["model"].dump(), path.string());
  auto network = MakeNetwork(info.network, info.camera, info.covariance.has_value());
  CopyWeights(file, info, path.string(), *network);
  return {info, network, precision};
}

ModelInfo CopyWeights(const std::filesystem::path& model, NetworkKind kind, PairNetwork& network) {
  const TensorFile file = ReadModel(model);
  const ModelInfo info = ModelInfoFromJson(file.header["model"].dump(), model.string());
  Require(info.network == kind, model.string(),
          fmt::format("is a network {} where {} is trained", Name(info.network), Name(kind)));
  CopyWeights(file, info, model.string(), network);
  return info;
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
  std::vector<SE3> motions;
  motions.reserve(pairs.size());
  for (const RelativeEstimate& answer : Ask(pairs, false)) {
    motions.push_back(answer.keyframe_from_live);
  }
  return motions;
}

std::vector<RelativeEstimate> PoseNetwork::Estimate(std::span<const CropPair> pairs) const {
  return Ask(pairs, info_.covariance.has_value());
}

std::vector<RelativeEstimate> PoseNetwork::Ask(std::span<const CropPair> pairs,
                                               bool covariance) const {
  const torch::InferenceMode inference;
  std::vector<RelativeEstimate> answers;
  answers.reserve(pairs.size());
  for (std::size_t from = 0; from < pairs.size(); from += kBatch) {
    const Prepared prepared =
        Prepare(info_, pairs.subspan(from, std::min(kBatch, pairs.size() - from)));
    PairEngine* engine = engine_->Get(*network_, info_.crop);
    PairAnswers out = engine != nullptr ? engine->Answer(prepared.images, prepared.pairs)
                                        : Forward(*network_, prepared);
    out.motion = out.motion.contiguous();
    if (covariance) {
      out.whitening = out.whitening.contiguous();
      out.agreement = out.agreement.contiguous();
    }
    for (std::int64_t i = 0; i < out.motion.size(0); ++i) {
      answers.push_back({MotionAt(out.motion, i), std::nullopt, Eigen::Vector3d::Zero()});
      if (covariance) {
        RelativeEstimate& answer = answers.back();
        answer.agreement =
            Eigen::Map<const Eigen::Vector3f>(out.agreement.data_ptr<float>() + 3 * i)
                .cast<double>();
        answer.covariance =
            info_.covariance->FactorOf(answer.agreement) * CovarianceAt(out.whitening, i);
      }
    }
  }
  return answers;
}

}  // namespace recollect::cnn
