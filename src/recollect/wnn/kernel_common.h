#pragma once

#include <bit>

#include "recollect/wnn/kernel.h"
#include "recollect/wnn/network.h"

namespace recollect::wnn {

// The neuron's answer after it has seen an entry at `distance`, which may be no better.
inline Answer Better(Answer best, const TieBreak& ties, int neuron, int distance, int entry) {
  const Answer offer =
      MakeAnswer(distance, TieBreak::Priority(ties.NeuronSalt(neuron), entry), entry);
  return offer < best ? offer : best;
}

// Kernel::probe, compiled once for each instruction set: few have a bit count in their baseline.
[[gnu::always_inline]] inline void ProbeEntry(const ScanEntry& entry, const ScanQuery& query,
                                              int begin, int end) {
  for (int n = begin; n < end; ++n) {
    const std::ptrdiff_t at = std::ptrdiff_t{n} * entry.stride;
    const std::uint64_t* q = query.pattern + std::ptrdiff_t{n} * kWords;
    const int distance = std::popcount(entry.low[at] ^ q[0]) + std::popcount(entry.high[at] ^ q[1]);
    Answer& best = query.answers[n];
    if (distance <= AnswerDistance(best)) {
      best = Better(best, query.ties, n, distance, entry.entry);
    }
  }
}

// The closer look's, likewise.
[[gnu::always_inline]] inline int DistanceUnder(const NeuronViews& views, int d,
                                                const std::uint64_t* entry) {
  return std::popcount(views.low[d] ^ entry[0]) + std::popcount(views.high[d] ^ entry[1]);
}

[[gnu::always_inline]] inline bool FindNearOf(const NeuronViews& views, const std::uint64_t* entry,
                                              int limit, std::uint64_t* near) {
  std::uint64_t any = 0;
  for (int begin = 0; begin < views.count; begin += 64) {
    const int end = begin + 64 < views.count ? begin + 64 : views.count;
    std::uint64_t bits = 0;
    for (int d = begin; d < end; ++d) {
      bits |= std::uint64_t{DistanceUnder(views, d, entry) <= limit} << (d - begin);
    }
    near[begin / 64] = bits;
    any |= bits;
  }
  return any != 0;
}

[[gnu::always_inline]] inline void MeasureOf(const NeuronViews& views, const std::uint64_t* low,
                                             const std::uint64_t* high, int count, Distances& all,
                                             std::uint64_t* least) {
  for (int e = 0; e < count; ++e) {
    const std::uint64_t entry[kWords] = {low[e], high[e]};
    least[e] = ~std::uint64_t{0};
    for (int d = 0; d < views.count; ++d) {
      const auto distance = static_cast<std::uint64_t>(DistanceUnder(views, d, entry));
      all.sum += distance;
      all.squares += distance * distance;
      least[e] = distance < least[e] ? distance : least[e];
    }
  }
}

// Kernel::scan_displaced.
[[gnu::always_inline]] inline void ScanDisplacedOf(const ScanBlock& block,
                                                   const DisplacedQuery& query, int begin,
                                                   int end) {
  for (int n = begin; n < end; ++n) {
    const NeuronViews views = query.Of(n);
    const std::ptrdiff_t at = std::ptrdiff_t{n} * block.capacity;
    for (std::uint64_t left = block.allowed; left != 0; left &= left - 1) {
      const int i = std::countr_zero(left);
      const std::uint64_t entry[kWords] = {block.low[at + i], block.high[at + i]};
      int least = kSynapses;
      for (int d = 0; d < views.count; ++d) {
        const int distance = DistanceUnder(views, d, entry);
        least = distance < least ? distance : least;
      }
      Answer& best = query.answers[n];
      if (least > AnswerDistance(best)) continue;
      best = Better(best, query.ties, n, least, block.first_entry + i);
    }
  }
}

inline void PlainAddVotes(const std::uint64_t* rows, int count, std::int16_t* votes) {
  for (int row = 0; row < count; ++row, votes += 64) {
    for (std::uint64_t left = rows[row]; left != 0; left &= left - 1) {
      ++votes[std::countr_zero(left)];
    }
  }
}

// Kernel::scan_displaced, find_near and measure in plain C++.
void PlainScanDisplaced(const ScanBlock& block, const DisplacedQuery& query, int begin, int end);
bool PlainFindNear(const NeuronViews& views, const std::uint64_t* entry, int limit,
                   std::uint64_t* near);
void PlainMeasure(const NeuronViews& views, const std::uint64_t* low, const std::uint64_t* high,
                  int count, Distances& all, std::uint64_t* least);

// Kernel::cells in plain C++.
void PlainCells(const std::int32_t* values, const std::int32_t* offsets, int begin, int end,
                std::uint64_t* pattern);

// Kernel::blur_columns for x in [begin, count), and blur_row, in plain C++: the others' tails.
inline constexpr int kBlurBias = 1 << 15;
inline constexpr int kBlurOffset = 256 * kBlurBias + (1 << 15);  // of the square, and to round
void PlainBlurColumns(const BlurTaps& taps, const std::uint8_t* const* rows, int begin, int count,
                      std::int16_t* sums);
void PlainBlurRow(const BlurTaps& taps, const std::int16_t* sums, int stride, int count,
                  std::uint8_t* out);
// The weights of two taps side by side; the one after the last has none.
inline int TwoWeights(const BlurTaps& taps, int tap) {
  return taps.weights[tap] | (tap + 1 < taps.count ? taps.weights[tap + 1] << 16 : 0);
}

}  // namespace recollect::wnn
