#pragma once

#include <cstdint>
#include <vector>

#include "recollect/core/random.h"
#include "recollect/matching/features.h"

namespace recollect::matching {

inline std::vector<std::int8_t> Descriptors(int count, Random& random) {
  std::vector<std::int8_t> all(static_cast<std::size_t>(count * kDescriptorBytes));
  for (auto& value : all) value = static_cast<std::int8_t>(random.Index(128));
  return all;
}

}  // namespace recollect::matching
