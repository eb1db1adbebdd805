#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>

namespace recollect {

// All of these throw Error naming the file when it is missing, empty, cut short, not an image or
// of another kind than asked for. Pixels come as stored: orientation tags are ignored, because
// calibrations are about stored pixels.

// Colour image, rows x cols of 8-bit B, G, R; a gray file gives three equal channels.
cv::Mat ReadColour(const std::filesystem::path& path);

// Gray image, rows x cols of 8 bits; a colour file is converted (0.299 R + 0.587 G + 0.114 B).
cv::Mat ReadGray(const std::filesystem::path& path);

// Depth along the camera's z axis, rows x cols of 32-bit floats in metres, 0 where unknown. The
// file is a 16-bit one-channel PNG in steps of `unit` metres (see Lap::depth_unit).
cv::Mat ReadDepth(const std::filesystem::path& path, double unit = 0.01);

struct ImageInfo {
  int width = 0, height = 0;
  int channels = 0;  // as stored; palettes count as 3
  int bits = 0;      // a channel
};
// Size and kind of an image; of PNG and JPEG files only the header is read.
ImageInfo ReadImageInfo(const std::filesystem::path& path);

}  // namespace recollect
