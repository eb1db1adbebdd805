#pragma once

#include <filesystem>

#include "recollect/geometry/camera.h"

namespace recollect {

// What readers ask of image files; only headers are read. Both throw Error naming the file.

// An image has the camera's size.
void RequireSize(const std::filesystem::path& image, const PinholeCamera& camera);

// A depth image has 16 bits, one channel and a size that DepthCamera knows.
void RequireDepth(const std::filesystem::path& image, const PinholeCamera& camera);

}  // namespace recollect
