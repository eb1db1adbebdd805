#pragma once

#include <cstdint>
#include <span>

#include "recollect/benchmark/corpus.h"
#include "recollect/wnn/answer.h"

namespace recollect {

// What a search over several processes of this machine gave.
struct ShardFigures {
  int ranks = 0;
  double search_ms = 0;      // median of a search, one-process figures are SearchFigures' exact_ms
  std::uint64_t digest = 0;  // of all answers to all live images
};

// Number that stands for all answers: equal digests mean equal bits.
std::uint64_t Digest(std::span<const wnn::Answer> answers, std::uint64_t before);

// Forks `ranks` processes, each with a slice of the corpus, which look up its live images together,
// `threads` threads each. To be called while this process has one thread. Throws Error when a rank
// fails.
ShardFigures RunShardBench(const Corpus& corpus, int ranks, int threads, std::uint64_t tie_seed);

}  // namespace recollect
