#include "recollect/cnn/pair_errors.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace recollect::cnn {
namespace {

constexpr std::size_t kBlock = 64;  // pairs between two reports of progress
constexpr double kShare = 0.95;
// Squared radius of the ellipsoid that holds that share of a normal distribution: of chi-square.
constexpr double kPoseBound = 12.592, kPositionBound = 7.815;  // six and three dimensions

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

// The least value that kShare of them, and no fewer, do not exceed.
double Bound(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto count = static_cast<double>(values.size());
  const auto at = static_cast<std::ptrdiff_t>(std::ceil(kShare * count - 1e-9)) - 1;
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

std::optional<double> ShareBelow(const std::vector<double>& values, double bound) {
  if (values.empty()) return std::nullopt;
  const auto below =
      std::count_if(values.begin(), values.end(), [&](double value) { return value <= bound; });
  return static_cast<double>(below) / static_cast<double>(values.size());
}

}  // namespace

void PairErrors::Add(const SE3& predicted, const SE3& truth) {
  // The key frame's pose is common to both, so errors show in its frame as in the world.
  position_m.push_back((predicted.translation() - truth.translation()).norm());
  heading_deg.push_back(HeadingDegrees(predicted, truth));
  no_motion_m.push_back(truth.translation().norm());
  no_motion_heading_deg.push_back(HeadingDegrees(SE3(), truth));
}

CovarianceCalibration PairErrors::Calibration() const {
  return Calibrate(pose_square, agreement, kShare, kPoseBound);
}

void PairErrors::Apply(const CovarianceCalibration& calibration) {
  for (std::size_t i = 0; i < pose_square.size(); ++i) {
    const double factor = calibration.FactorOf(agreement[i]);
    pose_square[i] /= factor;
    position_square[i] /= factor;
  }
}

PairFigures PairErrors::Figures() const {
  PairFigures figures;
  figures.pairs = static_cast<std::int64_t>(position_m.size());
  figures.position_mean_m = Mean(position_m);
  figures.position_median_m = Median(position_m);
  figures.position_p95_m = Bound(position_m);
  figures.heading_mean_deg = Mean(heading_deg);
  figures.heading_median_deg = Median(heading_deg);
  figures.heading_p95_deg = Bound(heading_deg);
  figures.no_motion_mean_m = Mean(no_motion_m);
  figures.no_motion_median_m = Median(no_motion_m);
  figures.no_motion_heading_mean_deg = Mean(no_motion_heading_deg);
  figures.inside_95 = ShareBelow(pose_square, kPoseBound);
  figures.position_inside_95 = ShareBelow(position_square, kPositionBound);
  return figures;
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
    const std::vector<RelativeEstimate> answers = network.Estimate(crops);
    for (std::size_t i = 0; i < block.size(); ++i) {
      const SE3 truth = data.KeyframeFromLive(data.pairs[block[i]]);
      const SE3& predicted = answers[i].keyframe_from_live;
      errors.Add(predicted, truth);
      if (!answers[i].covariance) continue;
      const Vector6d x = (predicted.Inverse() * truth).Log();
      const Matrix6d& covariance = *answers[i].covariance;
      const Eigen::Vector3d shift = x.tail<3>();
      const Eigen::Matrix3d of_shift = covariance.bottomRightCorner<3, 3>();
      errors.pose_square.push_back(x.dot(covariance.llt().solve(x)));
      errors.agreement.push_back(answers[i].agreement);
      errors.position_square.push_back(shift.dot(of_shift.llt().solve(shift)));
    }
    Report(progress, "evaluate pairs", static_cast<std::int64_t>(from + block.size()),
           static_cast<std::int64_t>(chosen.size()));
  }
  return errors;
}

}  // namespace recollect::cnn
