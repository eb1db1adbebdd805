#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "recollect/core/progress.h"
#include "recollect/wnn/memory.h"
#include "recollect/wnn/search.h"

namespace recollect::wnn {

struct CompressionOptions {
  int medoids = 100;       // patterns that each neuron keeps
  int rounds = 3;          // of k-means before the medoids are taken
  std::uint64_t seed = 1;  // of the first centres
};

// A memory in which each neuron keeps only some of its patterns, chosen for itself: k-means under
// the Hamming distance (a centre is its members' majority, bit by bit), then of each cluster the
// member nearest to the centre, which keeps its label. Searched like any memory, at a cost in
// proportion to the patterns kept.
class CompressedMemory {
 public:
  // Throws Error on options out of range. Takes time in proportion to
  // neurons x entries x medoids x rounds.
  CompressedMemory(const Memory& memory, ThreadPool& pool, const CompressionOptions& options = {},
                   const ProgressSink& progress = {});

  // Answers name entries of the memory that was compressed. options.allowed must be null.
  Recollection Recollect(std::span<const std::uint64_t> pattern, ThreadPool& pool,
                         const SearchOptions& options = {}) const;

  const Memory& memory() const { return kept_; }

 private:
  Memory kept_;                // entry i: every neuron's i-th medoid
  std::vector<int> entry_of_;  // neurons x medoids: the entry a medoid was
  std::vector<int> labels_;    // by entry of the memory that was compressed
};

}  // namespace recollect::wnn
