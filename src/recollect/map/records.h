#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>

#include "recollect/map/map.h"
#include "recollect/map/store.h"
#include "recollect/wnn/memory.h"

// How a map's values lie in its file; shared by reading (map.cc) and writing (build.cc).
namespace recollect {

// Meta table: the map's description as JSON.
inline constexpr const char* kDescriptionKey = "description";

// Reads it. Throws Error naming `where` when it is missing or damaged.
MapDescription DescriptionFrom(const std::optional<Bytes>& value, const std::string& where);

// Key frame table: little-endian as every machine this runs on.
struct KeyFrameRecord {
  double world_from_camera[12];  // 3x4, row-major
  double time;
  std::uint32_t lap, frame;
};
static_assert(std::is_trivially_copyable_v<KeyFrameRecord> && sizeof(KeyFrameRecord) == 112);

KeyFrameRecord ToRecord(const KeyFrame& key_frame);
KeyFrame FromRecord(const KeyFrameRecord& record);

// Pattern table: block b holds entries 64 b onwards, its capacity what its size makes it. Throws
// Error naming `where` when that does not fit the map's number of key frames.
wnn::BlockView ViewOfBlock(Bytes value, std::uint32_t block, int key_frames, int neurons,
                           const std::string& where);

}  // namespace recollect
