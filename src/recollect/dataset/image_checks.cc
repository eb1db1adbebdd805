#include "recollect/dataset/image_checks.h"

#include "recollect/core/error.h"
#include "recollect/dataset/image.h"
#include "recollect/dataset/lap.h"

namespace recollect {

void RequireSize(const std::filesystem::path& image, const PinholeCamera& camera) {
  const ImageInfo info = ReadImageInfo(image);
  Require(info.width == camera.width && info.height == camera.height, image.string(),
          fmt::format("{}x{} pixels where the lap's first image has {}x{}", info.width, info.height,
                      camera.width, camera.height));
}

void RequireDepth(const std::filesystem::path& image, const PinholeCamera& camera) {
  const ImageInfo info = ReadImageInfo(image);
  Require(info.bits == 16 && info.channels == 1, image.string(),
          fmt::format("depth has {} bits and {} channels where 16 and 1 belong", info.bits,
                      info.channels));
  DepthCamera(camera, info.width, info.height, image.string());
}

}  // namespace recollect
