#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "recollect/wnn/memory.h"
#include "recollect/wnn/network.h"

namespace recollect {
class ThreadPool;
}

namespace recollect::wnn {

// The committee's second look: at a few entries only, but under many displacements of the live
// image, finer than a search of the whole memory can afford. A neuron votes for every entry that
// lies nearer to what it sees than entries usually do by kNearDeviations standard deviations,
// under the displacement that it shares with the others, give or take one step. See
// docs/recognition.md, "A closer look".

// The live image under all displacements of a grid, row by row, as Encoder::EncodeDisplaced gives
// it.
struct DisplacedPatterns {
  std::span<const std::vector<std::uint64_t>> patterns;
  Displacements grid;
};

inline constexpr double kNearDeviations = 3;

// By neuron, the largest distance at which it votes, -1: none. `usual`: entries to learn that
// from, seen under every `stride`-th displacement.
std::vector<int> NearDistances(const Memory& memory, const DisplacedPatterns& live,
                               std::size_t stride, std::span<const int> usual, ThreadPool& pool);

struct Look {
  int votes = 0;
  int displacement = 0;  // under which it got these; of equals the first
};
// By entry, its votes under the displacement that gives most.
std::vector<Look> LookCloser(const Memory& memory, const DisplacedPatterns& live,
                             std::span<const int> near, std::span<const int> entries,
                             ThreadPool& pool);

}  // namespace recollect::wnn
