#pragma once

#include <cstdint>
#include <vector>

#include "recollect/core/random.h"
#include "recollect/wnn/network.h"

// Patterns that the tests and benchmarks of this folder make up.
namespace recollect::wnn {

inline std::vector<std::uint64_t> RandomPattern(int neurons, std::uint64_t seed) {
  std::vector<std::uint64_t> pattern(static_cast<std::size_t>(neurons) * kWords);
  for (std::size_t i = 0; i < pattern.size(); ++i) pattern[i] = SubSeed(seed, i);
  return pattern;
}

}  // namespace recollect::wnn
