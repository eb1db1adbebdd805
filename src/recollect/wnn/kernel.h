#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "recollect/wnn/answer.h"
#include "recollect/wnn/network.h"

namespace recollect::wnn {

// What a scan reads: the key frames of one block (see BlockView) that it may look at.
struct ScanBlock {
  const std::uint64_t* low = nullptr;   // bits of synapses 0..63, [neuron][frame]
  const std::uint64_t* high = nullptr;  // bits of synapses 64..127, [neuron][frame]
  int capacity = 0;                     // words a row, a multiple of 8
  int first_entry = 0;                  // number of the block's first key frame
  std::uint64_t allowed = 0;            // bit i: frame i may be looked at
};

// One entry, wherever it lies.
struct ScanEntry {
  const std::uint64_t* low = nullptr;   // its word of neuron 0's synapses 0..63
  const std::uint64_t* high = nullptr;  // and of synapses 64..127
  int stride = 0;                       // words from a neuron to the next
  int entry = 0;                        // its number
};

// What a scan looks for, and the nearest it has found so far, by neuron.
struct ScanQuery {
  const std::uint64_t* pattern = nullptr;  // neurons x kWords
  TieBreak ties;
  Answer* answers = nullptr;
};

// What one neuron sees of a live image under several displacements.
struct NeuronViews {
  const std::uint64_t* low = nullptr;   // bits of synapses 0..63, by displacement
  const std::uint64_t* high = nullptr;  // bits of synapses 64..127
  int count = 0;
};
// Of the first words, then the second ones.
inline NeuronViews ViewsOf(std::span<const std::uint64_t> words) {
  const std::size_t count = words.size() / kWords;
  return {words.data(), words.data() + count, static_cast<int>(count)};
}

// The same of all neurons, and the nearest entry found so far under any displacement, by neuron.
struct DisplacedQuery {
  const std::uint64_t* words = nullptr;  // [neuron][word][displacement]
  int count = 0;                         // displacements
  TieBreak ties;
  Answer* answers = nullptr;

  NeuronViews Of(int neuron) const {
    const std::uint64_t* low = words + std::ptrdiff_t{neuron} * kWords * count;
    return {low, low + count, count};
  }
};

// The taps of a blurring kernel, the same in both directions. Weights are 256ths and sum to 256, so
// that nothing is rounded but the result.
struct BlurTaps {
  const std::uint16_t* weights = nullptr;
  int count = 0;  // odd
};

struct Distances {
  std::uint64_t sum = 0, squares = 0;
};

// The inner loops for one instruction set. All of them give the same results.
struct Kernel {
  std::string_view name;
  // Patterns from packed bits (see PackBits): bit r of words[c], c in [0, count), is the packed bit
  // number at[r] + moved + c. at: of 64 places. count: at most kReach.
  void (*turn)(const std::uint8_t* packed, const std::int32_t* at, std::ptrdiff_t moved, int count,
               std::uint64_t* words);
  // The Minchinton cells of neurons [begin, end): pattern bits from the values under the synapses.
  // offsets: where in `values` each synapse looks, neurons x kSynapses. pattern: neurons x kWords.
  void (*cells)(const std::int32_t* values, const std::int32_t* offsets, int begin, int end,
                std::uint64_t* pattern);
  // sums[x] = sum over taps of weight * rows[tap][x], less 2^15, for x in [0, count)
  void (*blur_columns)(const BlurTaps& taps, const std::uint8_t* const* rows, int count,
                       std::int16_t* sums);
  // out[x] = sum over taps of weight * (sums[x + tap * stride] + 2^15) / 2^16, rounded
  void (*blur_row)(const BlurTaps& taps, const std::int16_t* sums, int stride, int count,
                   std::uint8_t* out);
  // Improves the answers of neurons [begin, end) by one entry.
  void (*probe)(const ScanEntry& entry, const ScanQuery& query, int begin, int end);
  // Improves the answers of neurons [begin, end) by the block's allowed frames. Reads the second
  // half of a pattern only where the first half does not rule it out; returns the number of 64-bit
  // words read.
  std::int64_t (*scan)(const ScanBlock& block, const ScanQuery& query, int begin, int end);
  // The same for `count` queries at a time, which share what is read from memory.
  void (*scan_batch)(const ScanBlock& block, const ScanQuery* queries, int count, int begin,
                     int end);
  // Improves the answers of neurons [begin, end) by the block's allowed frames, seen under any
  // displacement.
  void (*scan_displaced)(const ScanBlock& block, const DisplacedQuery& query, int begin, int end);

  // Of the closer look, for one neuron seen under `count` displacements and one entry's two words
  // of it: bit d of `near` is set where the distance is at most `limit`, of as many whole words as
  // hold all bits. Returns whether any is.
  bool (*find_near)(const NeuronViews& views, const std::uint64_t* entry, int limit,
                    std::uint64_t* near);
  // Adds the distances to `count` entries under all displacements, and their squares. low, high:
  // words of entries; least: by entry, the least of its distances.
  void (*measure)(const NeuronViews& views, const std::uint64_t* low, const std::uint64_t* high,
                  int count, Distances& all, std::uint64_t* least);
  // votes[64 * row + x] += bit x of rows[row]
  void (*add_votes)(const std::uint64_t* rows, int count, std::int16_t* votes);
};

// Each is null where the compiler's target lacks the instruction set.
extern const Kernel kPlainKernel;
const Kernel* Avx2Kernel();
const Kernel* Avx512Kernel();
const Kernel* NeonKernel();

// Those that this machine runs, the fastest first; the plain one is always among them.
std::span<const Kernel* const> Kernels();

}  // namespace recollect::wnn
