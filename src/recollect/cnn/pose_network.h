#pragma once

#include <filesystem>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <vector>

#include "recollect/cnn/model_info.h"
#include "recollect/cnn/precision.h"
#include "recollect/geometry/se3.h"

namespace recollect::cnn {

class PairNetwork;

// Two crops, 8-bit B, G, R of crop().width x crop().height: PoseNetwork::crop().Apply(image).
struct CropPair {
  cv::Mat live, key;
};

// A network's answer. truth = keyframe_from_live * Exp(x), x ~ N(0, covariance), rotation first:
// rad and m in the live camera's axes. No covariance where the network predicts none.
struct RelativeEstimate {
  SE3 keyframe_from_live;
  std::optional<Matrix6d> covariance;
  Eigen::Vector3d agreement;  // of what was seen (MotionFit), where there is a covariance
};

// A trained network, ready to answer. Not for several threads at once: each takes its own copy
// (copies share the weights).
class PoseNetwork {
 public:
  // Throws Error naming the file when it is missing, damaged or not a model. threads: how many
  // torch may use, in this and every other network of the program; 0: one for each core.
  static PoseNetwork Load(const std::filesystem::path& path, int threads = 0,
                          Precision precision = Precision::kFloat32);

  // The paper's network B before any training: its answer is "no motion", always. For images of
  // the given size; what evaluation and tests set a trained network against.
  static PoseNetwork Untrained(int image_width, int image_height);

  // The weights that the first question finds are those that all answers are made with: they are
  // packed for speed then (where the network has an engine and lies on the processor).
  PoseNetwork(ModelInfo info, std::shared_ptr<PairNetwork> network,
              Precision precision = Precision::kFloat32);

  // Written beside its target and renamed into place. Throws Error when that fails.
  void Save(const std::filesystem::path& path) const;

  const ModelInfo& info() const { return info_; }
  const Crop& crop() const { return info_.crop; }

  // The motion that takes points of the live camera to the key frame's: with G_K the key frame's
  // pose world_from_camera, the live pose is G_L = G_K * KeyframeFromLive(...). Throws Error where
  // a crop has another size or type than crop() says.
  SE3 KeyframeFromLive(const cv::Mat& live_crop, const cv::Mat& key_crop) const;

  // The same for many pairs at once, in their order. Of crops that share their pixels, as where
  // one live image is related to several key frames, the features are made once.
  std::vector<SE3> KeyframeFromLive(std::span<const CropPair> pairs) const;

  // The same motions, up to rounding, with how sure they are: calibrated on the validation pairs of
  // the training (ModelInfo::covariance).
  std::vector<RelativeEstimate> Estimate(std::span<const CropPair> pairs) const;

  const std::shared_ptr<PairNetwork>& network() const { return network_; }

 private:
  struct Engine;

  std::vector<RelativeEstimate> Ask(std::span<const CropPair> pairs, bool covariance) const;

  ModelInfo info_;
  std::shared_ptr<PairNetwork> network_;
  std::shared_ptr<Engine> engine_;
};

// Copies a model file's weights into a network of the same kind, made for any camera; where the
// file's network predicts no covariance, the weights for that stay as they are. What the file says
// of itself. Throws Error as PoseNetwork::Load does, and where the kinds differ.
ModelInfo CopyWeights(const std::filesystem::path& model, NetworkKind kind, PairNetwork& network);

}  // namespace recollect::cnn
