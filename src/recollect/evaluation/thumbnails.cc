#include "recollect/evaluation/thumbnails.h"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "recollect/core/error.h"
#include "recollect/dataset/image.h"

namespace recollect {
namespace {

constexpr int kWidths[] = {176, 144, 112, 80};
constexpr int kQualities[] = {70, 55, 42, 32};
constexpr std::size_t kMostBytes = 4500;  // of one image: more is not seen at that width

}  // namespace

std::string Base64(const std::vector<unsigned char>& bytes) {
  constexpr const char* kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto at = [&](std::size_t k) { return k < bytes.size() ? unsigned{bytes[k]} : 0u; };
    const unsigned group = at(i) << 16 | at(i + 1) << 8 | at(i + 2);
    for (unsigned digit = 0; digit < 4; ++digit) {
      text += i + digit > bytes.size() ? '=' : kDigits[group >> (18 - 6 * digit) & 63];
    }
  }
  return text;
}

std::string Thumbnail(const cv::Mat& image, std::size_t bytes) {
  Require(!image.empty(), "thumbnail", "of no image");
  std::vector<unsigned char> jpeg;
  for (const int width : kWidths) {
    cv::Mat small;
    const double scale = std::min(1.0, static_cast<double>(width) / image.cols);
    cv::resize(image, small, {}, scale, scale, cv::INTER_AREA);
    for (const int quality : kQualities) {
      cv::imencode(".jpg", small, jpeg,
                   {cv::IMWRITE_JPEG_QUALITY, quality, cv::IMWRITE_JPEG_OPTIMIZE, 1});
      if (jpeg.size() <= bytes) return Base64(jpeg);
    }
  }
  return Base64(jpeg);
}

std::size_t BytesAnImage(std::size_t count, std::size_t budget) {
  return std::min(kMostBytes, budget / 4 * 3 / std::max<std::size_t>(1, count));
}

nlohmann::json ReportImages(const std::vector<std::filesystem::path>& live,
                            const std::vector<int>& key_frames, const Map& map, std::size_t budget,
                            const ProgressSink& progress) {
  const std::set<int> keys(key_frames.begin(), key_frames.end());
  const std::size_t count = live.size() + keys.size();
  const std::size_t each = BytesAnImage(count, budget);
  nlohmann::json images = {{"live", nlohmann::json::array()}, {"keys", nlohmann::json::object()}};
  const auto report = [&] {
    Report(progress, "small images",
           static_cast<std::int64_t>(images["live"].size() + images["keys"].size()),
           static_cast<std::int64_t>(count));
  };
  for (const auto& file : live) {
    images["live"].push_back(Thumbnail(ReadColour(file), each));
    report();
  }
  for (const int key : keys) {
    images["keys"][std::to_string(key)] = Thumbnail(map.Image(key), each);
    report();
  }
  return images;
}

}  // namespace recollect
