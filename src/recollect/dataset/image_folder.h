#pragma once

#include <filesystem>
#include <vector>

namespace recollect {

// The image files directly in a folder (by extension: png, jpg, jpeg, bmp, ppm, pgm, tif, tiff, in
// any case), in order of name. Throws Error when it is no folder or holds none.
std::vector<std::filesystem::path> ImagesIn(const std::filesystem::path& folder);

}  // namespace recollect
