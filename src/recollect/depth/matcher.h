#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <string_view>

#include "recollect/core/parallel.h"
#include "recollect/depth/sgm.h"
#include "recollect/depth/sps.h"

namespace recollect::stereo {

enum class Method {
  kSps,   // semi-global matching, then slanted planes: dense
  kSgm,   // semi-global matching alone
  kSgbm,  // OpenCV's StereoSGBM: the rival
};

// "sps", "sgm" or "sgbm". Throws Error for anything else.
Method ParseMethod(std::string_view name);
std::string_view MethodName(Method method);

struct MatchOptions {
  Method method = Method::kSps;
  SgmOptions sgm;  // of kSgbm only the number of disparities
  SpsOptions sps;
};

// One of the methods, with memory that is kept from pair to pair. Not to be used by two threads at
// a time.
class Matcher {
 public:
  // Throws Error for bad options.
  Matcher(const MatchOptions& options, ThreadPool& pool);

  // left, right: 8 bits, gray or B, G, R, equally large. Disparities of the left image, 32-bit
  // float, kUnknown where there is none (never with kSps). Throws Error for other images.
  cv::Mat Disparity(const cv::Mat& left, const cv::Mat& right);

 private:
  MatchOptions options_;
  SemiGlobalMatcher sgm_;
};

// Disparities of OpenCV's StereoSGBM with the settings of its own example (blocks of 3 x 3, five
// paths, uniqueness 10, speckles of 100). left, right: 8 bits, gray or B, G, R.
cv::Mat SgbmDisparity(const cv::Mat& left, const cv::Mat& right, int disparities);

// Throws Error naming `where` unless both are 8-bit images, gray or B, G, R, of one size.
void RequirePair(const cv::Mat& left, const cv::Mat& right, const std::string& where);

// One channel of 8 bits.
cv::Mat ToGray(const cv::Mat& image);

}  // namespace recollect::stereo
