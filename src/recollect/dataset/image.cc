#include "recollect/dataset/image.h"

#include <array>
#include <cstdint>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string_view>

#include "recollect/core/error.h"
#include "recollect/core/files.h"

namespace recollect {
namespace {

constexpr std::string_view kPngStart("\x89PNG\r\n\x1a\n", 8);
constexpr std::string_view kJpegStart = "\xff\xd8";

// Cut-off files are found by their missing end mark: the decoders would print to stderr, and for
// JPEG go on with a gray rest. In a JPEG stream the mark cannot occur within the pixels.
bool HasItsEnd(std::string_view bytes) {
  if (bytes.starts_with(kPngStart)) return bytes.rfind("IEND") != std::string_view::npos;
  if (!bytes.starts_with(kJpegStart)) return true;
  const std::size_t scan = bytes.rfind("\xff\xda"), end = bytes.rfind("\xff\xd9");
  return scan != std::string_view::npos && end != std::string_view::npos && end > scan;
}

cv::Mat Decode(const std::filesystem::path& path, int flags) {
  const std::string bytes = ReadFile(path);
  Require(!bytes.empty(), path.string(), "is empty");
  Require(HasItsEnd(bytes), path.string(), "image is cut short");
  cv::Mat image;
  try {
    image = cv::imdecode(
        cv::Mat(1, static_cast<int>(bytes.size()), CV_8U, const_cast<char*>(bytes.data())),
        flags | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {
    // Refused below, as when the decoder gives nothing.
  }
  Require(!image.empty(), path.string(), "is not an image that can be decoded");
  return image;
}

cv::Mat DecodeEightBit(const std::filesystem::path& path, int flags) {
  cv::Mat image = Decode(path, flags | cv::IMREAD_ANYDEPTH);
  Require(image.depth() == CV_8U, path.string(), "has 16 bits a channel where 8 belong");
  return image;
}

int BigEndian(std::string_view bytes) {
  int value = 0;
  for (const char byte : bytes) value = value << 8 | static_cast<std::uint8_t>(byte);
  return value;
}

std::string_view Get(std::ifstream& file, std::array<char, 32>& buffer, std::streamsize count) {
  file.read(buffer.data(), count);
  return {buffer.data(), static_cast<std::size_t>(file.gcount())};
}

std::optional<ImageInfo> PngInfo(std::ifstream& file, std::array<char, 32>& buffer) {
  constexpr std::array kChannels = {1, 0, 3, 3, 2, 0, 4};  // by PNG's colour type
  const std::string_view header = Get(file, buffer, 18);   // IHDR's length, name and content
  if (header.size() < 18) return std::nullopt;
  const auto type = static_cast<std::size_t>(header[17]);
  if (type >= kChannels.size()) return std::nullopt;
  return ImageInfo{BigEndian(header.substr(8, 4)), BigEndian(header.substr(12, 4)), kChannels[type],
                   header[16]};
}

std::optional<ImageInfo> JpegInfo(std::ifstream& file, std::array<char, 32>& buffer) {
  // Segments, each a marker and a length, up to the frame header SOF0..15 (less DHT, JPG, DAC).
  file.seekg(2);
  for (;;) {
    const std::string_view segment = Get(file, buffer, 10);
    if (segment.size() < 10 || segment[0] != '\xff') return std::nullopt;
    const int marker = BigEndian(segment.substr(1, 1)), length = BigEndian(segment.substr(2, 2));
    if (marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc) {
      return ImageInfo{BigEndian(segment.substr(7, 2)), BigEndian(segment.substr(5, 2)),
                       BigEndian(segment.substr(9, 1)), segment[4]};
    }
    file.seekg(length + 2 - 10, std::ios::cur);
  }
}

}  // namespace

cv::Mat ReadColour(const std::filesystem::path& path) {
  return DecodeEightBit(path, cv::IMREAD_COLOR);
}

cv::Mat ReadGray(const std::filesystem::path& path) {
  return DecodeEightBit(path, cv::IMREAD_GRAYSCALE);
}

cv::Mat ReadDepth(const std::filesystem::path& path, double unit) {
  const cv::Mat steps = Decode(path, cv::IMREAD_UNCHANGED);
  Require(steps.type() == CV_16UC1, path.string(),
          fmt::format("depth has {} bits and {} channels where 16 and 1 belong",
                      8 * steps.elemSize1(), steps.channels()));
  cv::Mat depth;
  steps.convertTo(depth, CV_32F, unit);
  return depth;
}

ImageInfo ReadImageInfo(const std::filesystem::path& path) {
  std::array<char, 32> buffer{};
  std::ifstream file(path, std::ios::binary);
  const std::string_view start = Get(file, buffer, 8);
  if (start.starts_with(kPngStart) || start.starts_with(kJpegStart)) {
    const auto info = start.starts_with(kPngStart) ? PngInfo(file, buffer) : JpegInfo(file, buffer);
    Require(info && info->width > 0 && info->height > 0, path.string(),
            "is not an image that can be decoded");
    return *info;
  }
  const cv::Mat image = Decode(path, cv::IMREAD_UNCHANGED);
  return {image.cols, image.rows, image.channels(), static_cast<int>(8 * image.elemSize1())};
}

}  // namespace recollect
