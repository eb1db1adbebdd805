#include "recollect/dataset/image_folder.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <string>

#include "recollect/core/error.h"

namespace recollect {
namespace fs = std::filesystem;

std::vector<fs::path> ImagesIn(const fs::path& folder) {
  static const std::set<std::string> kExtensions = {".png", ".jpg", ".jpeg", ".bmp",
                                                    ".ppm", ".pgm", ".tif",  ".tiff"};
  Require(fs::is_directory(folder), folder.string(), "no such folder");
  std::vector<fs::path> images;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    std::string extension = entry.path().extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (entry.is_regular_file() && kExtensions.contains(extension)) images.push_back(entry.path());
  }
  Require(!images.empty(), folder.string(), "holds no images");
  std::sort(images.begin(), images.end());
  return images;
}

}  // namespace recollect
