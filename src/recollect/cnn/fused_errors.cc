#include "recollect/cnn/fused_errors.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "recollect/core/error.h"

namespace recollect::cnn {
namespace {

constexpr int kIterations = 10;
constexpr double kScale = 2;  // standard deviations at which an answer's weight is halved

Matrix6d UsualCovariance() {
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal() << 1e-4, 1e-4, 1e-4, 0.09, 0.09, 0.09;
  return covariance;
}

struct Weighed {
  SE3 pose;
  Matrix6d precision;

  Vector6d From(const SE3& start) const { return (start.Inverse() * pose).Log(); }
  // Cauchy's, of the squared distance in standard deviations.
  double Cost(const SE3& start) const {
    const Vector6d x = From(start);
    return std::log1p(x.dot(precision * x) / (kScale * kScale));
  }
  double Weight(const SE3& start) const {
    const Vector6d x = From(start);
    return 1 / (1 + x.dot(precision * x) / (kScale * kScale));
  }
};

double TotalCost(const std::vector<Weighed>& answers, const SE3& at) {
  double cost = 0;
  for (const Weighed& answer : answers) cost += answer.Cost(at);
  return cost;
}

}  // namespace

SE3 FuseAnswers(std::span<const PoseAnswer> answers) {
  Require(!answers.empty(), "fusion", "there are no answers");
  std::vector<Weighed> weighed;
  for (const PoseAnswer& answer : answers) {
    weighed.push_back(
        {answer.world_from_live, answer.covariance.llt().solve(Matrix6d::Identity())});
  }
  // From the answer that the others contradict least; of equals the first.
  SE3 pose;
  double least = std::numeric_limits<double>::max();
  for (const Weighed& answer : weighed) {
    const double cost = TotalCost(weighed, answer.pose);
    if (cost < least) {
      least = cost;
      pose = answer.pose;
    }
  }
  for (int i = 0; i < kIterations; ++i) {
    Matrix6d normal = Matrix6d::Zero();
    Vector6d right = Vector6d::Zero();
    for (const Weighed& answer : weighed) {
      const Matrix6d precision = answer.Weight(pose) * answer.precision;
      normal += precision;
      right += precision * answer.From(pose);
    }
    pose = pose * SE3::Exp(normal.ldlt().solve(right));
  }
  return pose;
}

std::vector<PairErrors> EvaluateNearest(const PoseNetwork& network, const PairData& data, int most,
                                        const ProgressSink& progress) {
  Require(most >= 1, "key frames", "are to be one or more");
  const auto count = static_cast<std::size_t>(most);
  std::map<std::size_t, std::vector<Pair>> by_live;
  for (const Pair& pair : data.pairs) by_live[pair.live].push_back(pair);
  std::erase_if(by_live, [&](const auto& entry) { return entry.second.size() < count; });
  Require(!by_live.empty(), "key frames",
          fmt::format("no live frame has {} of them within reach", most), "ask for fewer");

  std::vector<PairErrors> errors(count);
  std::int64_t done = 0;
  for (auto& [live, pairs] : by_live) {
    std::sort(pairs.begin(), pairs.end(), [&](const Pair& a, const Pair& b) {
      return data.KeyframeFromLive(a).translation().squaredNorm() <
             data.KeyframeFromLive(b).translation().squaredNorm();
    });
    std::vector<CropPair> crops;
    for (std::size_t i = 0; i < count; ++i) {
      crops.push_back({data.frames[live].image, data.frames[pairs[i].key].image});
    }
    const std::vector<RelativeEstimate> estimates = network.Estimate(crops);
    std::vector<PoseAnswer> answers;
    const SE3 nearest_from_world = data.frames[pairs[0].key].world_from_camera.Inverse();
    for (std::size_t i = 0; i < count; ++i) {
      answers.push_back(
          {data.frames[pairs[i].key].world_from_camera * estimates[i].keyframe_from_live,
           estimates[i].covariance.value_or(UsualCovariance())});
      errors[i].Add(nearest_from_world * FuseAnswers(answers), data.KeyframeFromLive(pairs[0]));
    }
    Report(progress, "fuse answers", ++done, static_cast<std::int64_t>(by_live.size()));
  }
  return errors;
}

}  // namespace recollect::cnn
