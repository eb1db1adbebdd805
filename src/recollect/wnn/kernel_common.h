#pragma once

#include "recollect/wnn/kernel.h"
#include "recollect/wnn/network.h"

namespace recollect::wnn {

// The neuron's answer after it has seen an entry at `distance`, which may be no better.
inline Answer Better(Answer best, const TieBreak& ties, int neuron, int distance, int entry) {
  const Answer offer =
      MakeAnswer(distance, TieBreak::Priority(ties.NeuronSalt(neuron), entry), entry);
  return offer < best ? offer : best;
}

// Kernel::cells in plain C++.
void PlainCells(const std::int32_t* values, const std::int32_t* offsets, int begin, int end,
                std::uint64_t* pattern);

}  // namespace recollect::wnn
