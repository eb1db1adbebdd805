#include "recollect/map/map.h"

#include <cstring>
#include <opencv2/imgcodecs.hpp>

#include "recollect/core/error.h"
#include "recollect/map/records.h"

namespace recollect {
Map Map::Open(const std::filesystem::path& file) {
  StoreReader store(file);
  MapDescription description = DescriptionFrom(store.Get(kDescriptionKey), file.string());
  return {std::move(store), std::move(description)};
}

Map::Map(StoreReader store, MapDescription description)
    : store_(std::move(store)),
      description_(std::move(description)),
      memory_(description_.network.neurons()) {
  const std::string where = store_.file().string();
  const auto frames = static_cast<std::size_t>(description_.KeyFrames());
  for (const auto& [table, name] :
       {std::pair{Table::kKeyFrames, "key frames"}, std::pair{Table::kImages, "images"}}) {
    Require(store_.Count(table) == frames, where,
            fmt::format("{} {} where its description counts {}", store_.Count(table), name, frames),
            "create the map again");
  }
  for (std::uint32_t block = 0; block * wnn::kBlockFrames < frames; ++block) {
    const auto bytes = store_.Get(Table::kPatterns, block);
    Require(bytes.has_value(), where, fmt::format("block {} of the patterns is missing", block),
            "create the map again");
    memory_.AddBlock(ViewOfBlock(*bytes, block, static_cast<int>(frames),
                                 description_.network.neurons(), where));
  }
}

KeyFrame Map::At(int key) const {
  const std::string where = store_.file().string();
  Require(key >= 0 && key < size(), where,
          fmt::format("no key frame {}, there are {}", key, size()));
  const auto bytes = store_.Get(Table::kKeyFrames, static_cast<std::uint32_t>(key));
  Require(bytes && bytes->size() == sizeof(KeyFrameRecord), where,
          fmt::format("the record of key frame {} is damaged", key), "create the map again");
  KeyFrameRecord record;
  std::memcpy(&record, bytes->data(), sizeof(record));
  return FromRecord(record);
}

std::optional<Bytes> Map::Geometry(int key) const {
  return store_.Get(Table::kGeometry, static_cast<std::uint32_t>(key));
}

cv::Mat Map::Image(int key) const {
  const std::string where = store_.file().string();
  Require(key >= 0 && key < size(), where,
          fmt::format("no key frame {}, there are {}", key, size()));
  const auto bytes = store_.Get(Table::kImages, static_cast<std::uint32_t>(key));
  cv::Mat image;
  if (bytes) {
    // OpenCV wants a matrix that may be written to, and does not write.
    auto* data = const_cast<std::byte*>(bytes->data());
    image = cv::imdecode(cv::Mat(1, static_cast<int>(bytes->size()), CV_8UC1, data),
                         cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
  }
  Require(!image.empty() && image.cols == description_.camera.left.width &&
              image.rows == description_.camera.left.height,
          where, fmt::format("the image of key frame {} is damaged", key), "create the map again");
  return image;
}

}  // namespace recollect
