#include "recollect/evaluation/failures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <span>
#include <utility>
#include <vector>

#include "recollect/core/files.h"

namespace recollect {
namespace {

constexpr double kOff = 0.5;  // metres
constexpr std::size_t kRows = 8;
constexpr int kGap = 6, kCaption = 22;  // pixels

PoseError ErrorOf(const LiveFrame& f) {
  return Compare(f.answer.world_from_camera, f.true_world_from_camera);
}

cv::Mat SheetRow(const LiveFrame& f, const Map& map, double error) {
  const cv::Size size = f.picture.size();
  cv::Mat row(size.height + kCaption + kGap, 3 * size.width + 2 * kGap, CV_8UC3,
              cv::Scalar::all(255));
  const std::array<cv::Mat, 3> pictures = {f.picture, map.Image(f.answer.key_frame),
                                           map.Image(f.nearest_key_frame)};
  const std::string fault = f.fault.empty() || f.fault == "none" ? "" : " (" + f.fault + ")";
  const std::array<std::string, 3> captions = {
      fmt::format("live {}{}: {}, {:.2f} m off", f.frame, fault, Name(f.answer.state), error),
      fmt::format("recollected: key frame {}", f.answer.key_frame),
      fmt::format("nearest: key frame {}", f.nearest_key_frame)};
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const int left = static_cast<int>(i) * (size.width + kGap);
    cv::Mat there = row(cv::Rect(left, kCaption, size.width, size.height));
    cv::resize(pictures[i], there, size, 0, 0, cv::INTER_AREA);
    cv::putText(row, captions[i], {left + 2, kCaption - 7}, cv::FONT_HERSHEY_SIMPLEX, 0.4,
                cv::Scalar::all(0), 1, cv::LINE_AA);
  }
  return row;
}

}  // namespace

bool IsFailure(const Localization& answer, const PoseError& error) {
  return answer.state != State::kLocalised || error.position_m >= kOff;
}

int WriteFailures(const Evaluation& evaluation, const Map& map, const std::filesystem::path& jpg) {
  std::vector<std::pair<double, const LiveFrame*>> worst;
  for (const LiveFrame& f : evaluation.frames) {
    if (!f.picture.empty()) worst.emplace_back(ErrorOf(f).position_m, &f);
  }
  if (worst.empty()) return 0;
  std::stable_sort(worst.begin(), worst.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<cv::Mat> rows;
  for (const auto& [error, frame] : std::span(worst).first(std::min(kRows, worst.size()))) {
    rows.push_back(SheetRow(*frame, map, error));
  }
  cv::Mat sheet;
  cv::vconcat(rows, sheet);
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", sheet, bytes, {cv::IMWRITE_JPEG_QUALITY, 80});
  AtomicWrite(jpg, std::string(bytes.begin(), bytes.end()));
  return static_cast<int>(worst.size());
}

}  // namespace recollect
