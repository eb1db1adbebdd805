#include "recollect/depth/temporal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>

#include "recollect/core/error.h"
#include "recollect/dataset/image.h"
#include "recollect/depth/disparity.h"

namespace recollect::stereo {
namespace {

double Median(std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void Append(std::vector<double>& all, const std::vector<double>& some) {
  all.insert(all.end(), some.begin(), some.end());
}

TemporalAgreement CompareMethod(const Lap& lap, const MatchOptions& options, ThreadPool& pool,
                                const ProgressSink& progress) {
  Matcher matcher(options, pool);
  std::vector<double> dense, valid;
  double known = 0, pixels = 0;
  cv::Mat before, before_filled;
  for (std::size_t i = 0; i < lap.frames.size(); ++i) {
    const Frame& frame = lap.frames[i];
    cv::Mat now, now_filled;
    if (!frame.right.empty()) {
      const cv::Mat disparity = matcher.Disparity(ReadColour(frame.left), ReadColour(frame.right));
      known += cv::countNonZero(disparity >= 0);
      pixels += static_cast<double>(disparity.total());
      now = DepthFromDisparity(disparity, lap.camera);
      now_filled = DepthFromDisparity(FillFromBackground(disparity), lap.camera);
    }
    if (!before.empty() && !now.empty()) {
      const SE3 motion = lap.WorldFromCamera(i).Inverse() * lap.WorldFromCamera(i - 1);
      Append(valid, MovedDepthErrors(before, now, motion, lap.camera.left));
      Append(dense, MovedDepthErrors(before_filled, now_filled, motion, lap.camera.left));
    }
    before = now;
    before_filled = now_filled;
    Report(progress, std::string(MethodName(options.method)), static_cast<std::int64_t>(i) + 1,
           std::ssize(lap.frames));
  }
  return {options.method, Median(dense), Median(valid), pixels > 0 ? known / pixels : 0};
}

}  // namespace

std::vector<double> MovedDepthErrors(const cv::Mat& depth, const cv::Mat& next_depth,
                                     const SE3& next_from_this, const PinholeCamera& camera) {
  std::vector<double> errors;
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      const double z = depth.at<float>(v, u);
      if (!(z > 0) || std::isinf(z)) continue;
      const Eigen::Vector3d moved = next_from_this * camera.Unproject(u, v, z);
      if (moved.z() <= 0) continue;
      const Eigen::Vector2d pixel = camera.Project(moved);
      if (!camera.Contains(pixel)) continue;
      const double there = next_depth.at<float>(static_cast<int>(std::lround(pixel.y())),
                                                static_cast<int>(std::lround(pixel.x())));
      if (there > 0 && !std::isinf(there)) errors.push_back(std::abs(moved.z() - there) / there);
    }
  }
  return errors;
}

std::vector<TemporalAgreement> CompareOverTime(const Lap& lap, const MatchOptions& options,
                                               ThreadPool& pool, const ProgressSink& progress) {
  bool any = false;
  for (std::size_t i = 1; i < lap.frames.size(); ++i) {
    any = any || (!lap.frames[i - 1].right.empty() && !lap.frames[i].right.empty());
  }
  Require(any, lap.folder.string(), "no two frames in a row have right images");
  std::vector<TemporalAgreement> agreements;
  for (const Method method : {Method::kSps, Method::kSgm, Method::kSgbm}) {
    MatchOptions one = options;
    one.method = method;
    agreements.push_back(CompareMethod(lap, one, pool, progress));
  }
  return agreements;
}

}  // namespace recollect::stereo
