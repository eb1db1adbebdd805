#include "recollect/map/records.h"

#include <algorithm>

#include "recollect/core/error.h"

namespace recollect {

MapDescription DescriptionFrom(const std::optional<Bytes>& value, const std::string& where) {
  Require(value.has_value(), where, "has no description", "this is not a whole Recollect map");
  return ParseMapDescription(
      std::string(reinterpret_cast<const char*>(value->data()), value->size()), where);
}

KeyFrameRecord ToRecord(const KeyFrame& key_frame) {
  KeyFrameRecord record{};
  const Eigen::Matrix4d m = key_frame.world_from_camera.Matrix();
  for (int i = 0; i < 12; ++i) record.world_from_camera[i] = m(i / 4, i % 4);
  record.time = key_frame.time;
  record.lap = key_frame.lap;
  record.frame = key_frame.frame;
  return record;
}

KeyFrame FromRecord(const KeyFrameRecord& record) {
  Eigen::Matrix<double, 3, 4> m;
  for (int i = 0; i < 12; ++i) m(i / 4, i % 4) = record.world_from_camera[i];
  return {SE3(m.leftCols<3>(), m.col(3)), record.time, record.lap, record.frame};
}

wnn::BlockView ViewOfBlock(Bytes value, std::uint32_t block, int key_frames, int neurons,
                           const std::string& where) {
  const int frames =
      std::min(wnn::kBlockFrames, key_frames - static_cast<int>(block) * wnn::kBlockFrames);
  const std::size_t column = wnn::BlockWords(neurons, 1) * sizeof(std::uint64_t);
  const auto capacity = static_cast<int>(value.size() / column);
  Require(value.size() % column == 0 && capacity >= frames && capacity <= wnn::kBlockFrames &&
              capacity % 8 == 0,
          where, fmt::format("block {} of the patterns is damaged", block), "create the map again");
  return {reinterpret_cast<const std::uint64_t*>(value.data()), frames, capacity};
}

}  // namespace recollect
