#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "recollect/wnn/committee.h"
#include "recollect/wnn/entry_set.h"
#include "recollect/wnn/memory.h"

namespace recollect {
class ThreadPool;
}

namespace recollect::wnn {

struct Kernel;

// When a search may stop asking neurons.
enum class Stop {
  kNever,      // every neuron answers
  kCertain,    // once no vote still to come can change the winner: it is the full committee's
  kConfident,  // once the full committee would choose otherwise with a chance <= error_bound only
};

struct SearchOptions {
  Stop stop = Stop::kNever;
  double error_bound = 1e-4;          // for kConfident
  std::uint64_t tie_seed = 1;         // of the dice neurons throw between equally near entries
  const EntrySet* allowed = nullptr;  // entries to look at; null: all
  const Kernel* kernel = nullptr;     // null: the fastest this machine runs
};

// Asks neurons for their nearest entry (Hamming distance of 128 bits) and counts the votes. Same
// bits with any number of threads, kernel and cut into blocks. pattern: neurons x kWords words, as
// Encoder gives them. Throws Error on a pattern of another network.
Recollection Recollect(const Memory& memory, std::span<const std::uint64_t> pattern,
                       ThreadPool& pool, const SearchOptions& options = {});

// The same for several images (2 to 16 pay best), which share what is read from memory: all
// neurons answer, options.stop is not heeded.
std::vector<Recollection> RecollectBatch(const Memory& memory,
                                         std::span<const std::span<const std::uint64_t>> patterns,
                                         ThreadPool& pool, const SearchOptions& options = {});

// The answers of all neurons, before votes are counted. first_entry: what number the memory's entry
// 0 goes by. Searches of the slices of a larger memory meet by the minimum of their answers.
std::vector<Answer> AskAll(const Memory& memory, std::span<const std::uint64_t> pattern,
                           ThreadPool& pool, const SearchOptions& options = {},
                           int first_entry = 0);

}  // namespace recollect::wnn
