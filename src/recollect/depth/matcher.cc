#include "recollect/depth/matcher.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "recollect/core/error.h"

namespace recollect::stereo {

Method ParseMethod(std::string_view name) {
  for (const Method method : {Method::kSps, Method::kSgm, Method::kSgbm}) {
    if (name == MethodName(method)) return method;
  }
  throw Error(std::string(name), "is no stereo method", "there are sps, sgm and sgbm");
}

std::string_view MethodName(Method method) {
  switch (method) {
    case Method::kSgm:
      return "sgm";
    case Method::kSgbm:
      return "sgbm";
    case Method::kSps:
      break;
  }
  return "sps";
}

void RequirePair(const cv::Mat& left, const cv::Mat& right, const std::string& where) {
  for (const cv::Mat& image : {left, right}) {
    Require(image.type() == CV_8UC1 || image.type() == CV_8UC3, where,
            fmt::format("image has {} bits and {} channels where 8 bits and 1 or 3 channels belong",
                        8 * image.elemSize1(), image.channels()));
  }
  Require(left.size() == right.size(), where,
          fmt::format("left image is {} x {} pixels, right image {} x {}", left.cols, left.rows,
                      right.cols, right.rows),
          "both must be of one size");
}

cv::Mat ToGray(const cv::Mat& image) {
  if (image.channels() == 1) return image;
  cv::Mat gray;
  cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  return gray;
}

Matcher::Matcher(const MatchOptions& options, ThreadPool& pool)
    : options_(options), sgm_(options.sgm, pool) {
  CheckOptions(options.sps);
}

cv::Mat Matcher::Disparity(const cv::Mat& left, const cv::Mat& right) {
  RequirePair(left, right, "stereo pair");
  if (options_.method == Method::kSgbm) return SgbmDisparity(left, right, options_.sgm.disparities);
  const cv::Mat matched = sgm_.Disparity(ToGray(left), ToGray(right));
  if (options_.method == Method::kSgm) return matched;
  return SmoothBySlantedPlanes(left, matched, options_.sps).disparity;
}

cv::Mat SgbmDisparity(const cv::Mat& left, const cv::Mat& right, int disparities) {
  constexpr int kBlock = 3;
  const int area = left.channels() * kBlock * kBlock;
  cv::Mat sixteenths, disparity;
  cv::StereoSGBM::create(0, disparities, kBlock, 8 * area, 32 * area, 1, 63, 10, 100, 32,
                         cv::StereoSGBM::MODE_SGBM)
      ->compute(left, right, sixteenths);
  sixteenths.convertTo(disparity, CV_32F, 1.0 / 16);
  disparity.setTo(kUnknown, disparity < 0);
  return disparity;
}

}  // namespace recollect::stereo
