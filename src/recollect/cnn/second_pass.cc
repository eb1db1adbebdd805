#include "recollect/cnn/second_pass.h"

#include <limits>
#include <map>
#include <set>
#include <utility>

namespace recollect::cnn {
namespace {

constexpr double kAlike = 0.5;  // cosine of the angle between views of one place

std::size_t NearestKey(const PairData& data, const std::set<std::size_t>& keys, const SE3& pose,
                       std::size_t otherwise) {
  std::size_t best = otherwise;
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t key : keys) {
    const SE3& own = data.frames[key].world_from_camera;
    const double distance = (own.translation() - pose.translation()).squaredNorm();
    if (distance >= least || own.rotation().col(2).dot(pose.rotation().col(2)) < kAlike) continue;
    least = distance;
    best = key;
  }
  return best;
}

}  // namespace

PairErrors EvaluateSecondPass(const PoseNetwork& network, const PairData& data,
                              const ProgressSink& progress) {
  std::set<std::size_t> keys;
  std::map<std::size_t, std::vector<std::size_t>> by_live;
  for (const Pair& pair : data.pairs) {
    keys.insert(pair.key);
    by_live[pair.live].push_back(pair.key);
  }
  const auto ask = [&](std::size_t live, const std::vector<std::size_t>& of) {
    std::vector<CropPair> crops;
    for (const std::size_t key : of) {
      crops.push_back({data.frames[live].image, data.frames[key].image});
    }
    const std::vector<SE3> motions = network.KeyframeFromLive(crops);
    std::map<std::size_t, SE3> poses;  // world_from_live, by key frame
    for (std::size_t i = 0; i < of.size(); ++i) {
      poses[of[i]] = data.frames[of[i]].world_from_camera * motions[i];
    }
    return poses;
  };

  PairErrors errors;
  for (const auto& [live, of] : by_live) {
    std::map<std::size_t, SE3> poses = ask(live, of);
    for (const std::size_t key : of) {
      const std::size_t nearest = NearestKey(data, keys, poses.at(key), key);
      if (!poses.contains(nearest)) poses.merge(ask(live, {nearest}));
      const SE3 key_from_world = data.frames[key].world_from_camera.Inverse();
      errors.Add(key_from_world * poses.at(nearest), data.KeyframeFromLive({live, key}));
    }
    Report(progress, "second pass", static_cast<std::int64_t>(errors.position_m.size()),
           static_cast<std::int64_t>(data.pairs.size()));
  }
  return errors;
}

}  // namespace recollect::cnn
