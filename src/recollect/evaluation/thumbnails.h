#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "recollect/core/progress.h"
#include "recollect/map/map.h"

namespace recollect {

std::string Base64(const std::vector<unsigned char>& bytes);

// A small JPEG, in base64: of the width and quality, as good as they can be, that keep it below
// `bytes` (before base64); the smallest, where none does.
std::string Thumbnail(const cv::Mat& image, std::size_t bytes);

// How many of those an image may take so that `count` of them fit into `budget` bytes of text.
std::size_t BytesAnImage(std::size_t count, std::size_t budget);

// The images of a report, all of them together within `budget` bytes of text or so: live ones in
// their order, and each of the key frames once. {"live": [...], "keys": {"12": ...}}
nlohmann::json ReportImages(const std::vector<std::filesystem::path>& live,
                            const std::vector<int>& key_frames, const Map& map, std::size_t budget,
                            const ProgressSink& progress = {});

}  // namespace recollect
