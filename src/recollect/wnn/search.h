#pragma once

#include <cstdint>
#include <span>

#include "recollect/wnn/committee.h"
#include "recollect/wnn/memory.h"

namespace recollect {
class ThreadPool;
}

namespace recollect::wnn {

struct SearchOptions {
  std::uint64_t tie_seed = 1;  // of the dice that neurons throw between equally near entries
};

// Asks every neuron for its nearest entry (Hamming distance of 128 bits), then counts the votes.
// The same answer with any number of threads. pattern: neurons x kWords words, as Encoder gives
// them; throws Error on a pattern of another network.
Recollection Recollect(const Memory& memory, std::span<const std::uint64_t> pattern,
                       ThreadPool& pool, const SearchOptions& options = {});

}  // namespace recollect::wnn
