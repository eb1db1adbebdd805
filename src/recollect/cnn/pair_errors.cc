#include "recollect/cnn/pair_errors.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace recollect::cnn {
namespace {

constexpr std::size_t kBlock = 64;  // pairs between two reports of progress

double HeadingDegrees(const SE3& a, const SE3& b) {
  const double cosine = a.rotation().col(2).dot(b.rotation().col(2));
  const double sine = a.rotation().col(2).cross(b.rotation().col(2)).norm();
  return std::atan2(sine, cosine) * 180 / std::numbers::pi;
}

double Mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) /
         std::max(1.0, static_cast<double>(values.size()));
}

double Median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return (*std::max_element(values.begin(), middle) + *middle) / 2;
}

}  // namespace

PairFigures PairErrors::Figures() const {
  return {static_cast<std::int64_t>(position_m.size()),
          Mean(position_m),
          Median(position_m),
          Mean(heading_deg),
          Median(heading_deg),
          Mean(no_motion_m),
          Median(no_motion_m),
          Mean(no_motion_heading_deg)};
}

PairErrors EvaluatePairs(const PoseNetwork& network, const PairData& data,
                         std::span<const std::size_t> chosen, const ProgressSink& progress) {
  std::vector<std::size_t> all;
  if (chosen.empty()) {
    all.resize(data.pairs.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    chosen = all;
  }
  PairErrors errors;
  for (std::size_t from = 0; from < chosen.size(); from += kBlock) {
    const auto block = chosen.subspan(from, std::min(kBlock, chosen.size() - from));
    std::vector<CropPair> crops;
    for (const std::size_t i : block) {
      crops.push_back(
          {data.frames[data.pairs[i].live].image, data.frames[data.pairs[i].key].image});
    }
    const std::vector<SE3> predicted = network.KeyframeFromLive(crops);
    for (std::size_t i = 0; i < block.size(); ++i) {
      // The key frame's pose is common to both, so errors show in its frame as in the world.
      const SE3 truth = data.KeyframeFromLive(data.pairs[block[i]]);
      errors.position_m.push_back((predicted[i].translation() - truth.translation()).norm());
      errors.heading_deg.push_back(HeadingDegrees(predicted[i], truth));
      errors.no_motion_m.push_back(truth.translation().norm());
      errors.no_motion_heading_deg.push_back(HeadingDegrees(SE3(), truth));
    }
    Report(progress, "evaluate pairs", static_cast<std::int64_t>(from + block.size()),
           static_cast<std::int64_t>(chosen.size()));
  }
  return errors;
}

}  // namespace recollect::cnn
