#include "recollect/depth/pair_check.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <vector>

#include "recollect/core/error.h"

namespace recollect::stereo {
namespace {

constexpr int kCorners = 400;
constexpr int kEnough = 20;       // matches to judge a pair by
constexpr double kReturn = 0.5;   // px within which a point must come back to its start
constexpr double kRowsMatch = 1;  // px
constexpr double kSwapped = 0.7;  // share of points moved the wrong way; false matches are fewer

using Points = std::vector<cv::Point2f>;

Points Follow(const cv::Mat& from, const cv::Mat& to, const Points& points,
              std::vector<std::uint8_t>& found) {
  Points moved;
  std::vector<float> errors;
  cv::calcOpticalFlowPyrLK(from, to, points, moved, found, errors, cv::Size(21, 21), 5);
  return moved;
}

}  // namespace

PairCheck CheckPair(const cv::Mat& left, const cv::Mat& right) {
  Points corners;
  cv::goodFeaturesToTrack(left, corners, kCorners, 0.01, 8);
  PairCheck check;
  if (corners.empty()) return check;
  std::vector<std::uint8_t> there, back;
  const Points seen = Follow(left, right, corners, there);
  const Points returned = Follow(right, left, seen, back);
  std::vector<double> rows;
  int moved = 0, reversed = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (there[i] == 0 || back[i] == 0 || cv::norm(returned[i] - corners[i]) > kReturn) continue;
    rows.push_back(std::abs(static_cast<double>(seen[i].y - corners[i].y)));
    const float disparity = corners[i].x - seen[i].x;
    moved += std::abs(disparity) >= 1 ? 1 : 0;
    reversed += disparity <= -1 ? 1 : 0;
  }
  check.matches = static_cast<int>(rows.size());
  if (rows.empty()) return check;
  const auto middle = rows.begin() + static_cast<std::ptrdiff_t>(rows.size() / 2);
  std::nth_element(rows.begin(), middle, rows.end());
  check.vertical_px = *middle;
  check.reversed = moved >= kEnough ? static_cast<double>(reversed) / moved : 0;
  return check;
}

void RequireLeftIsLeft(const PairCheck& check, const std::string& where) {
  Require(check.reversed < kSwapped, where,
          fmt::format("left and right images are swapped: {:.0f} % of the points lie farther right "
                      "in the right one",
                      100 * check.reversed),
          "give them the other way round");
}

std::string RectificationWarning(const PairCheck& check, const std::string& where) {
  if (check.matches < kEnough || check.vertical_px <= kRowsMatch) return "";
  return fmt::format(
      "{}: the pair is not rectified: matched points differ by {:.1f} rows in the median; rectify "
      "the images first",
      where, check.vertical_px);
}

}  // namespace recollect::stereo
