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

[[gnu::always_inline]] inline bool FindNearFrom(int first, const NeuronViews& views,
                                                const std::uint64_t* entry, int limit,
                                                std::uint8_t* near) {
  bool any = false;
  for (int d = first; d < views.count; ++d) {
    const bool is_near = DistanceUnder(views, d, entry) <= limit;
    near[d] = is_near ? 1 : 0;
    any |= is_near;
  }
  return any;
}

[[gnu::always_inline]] inline void AddDistancesFrom(int first, const NeuronViews& views,
                                                    const std::uint64_t* entry, std::uint64_t& sum,
                                                    std::uint64_t& squares) {
  for (int d = first; d < views.count; ++d) {
    const auto distance = static_cast<std::uint64_t>(DistanceUnder(views, d, entry));
    sum += distance;
    squares += distance * distance;
  }
}

[[gnu::always_inline]] inline void SpreadOverNeighbours(const std::uint8_t* near, int stride,
                                                        int from, int to, std::uint8_t* scratch,
                                                        std::uint16_t* votes) {
  for (int i = from - stride; i < to + stride; ++i) {
    scratch[i] = static_cast<std::uint8_t>(near[i - 1] | near[i] | near[i + 1]);
  }
  for (int i = from; i < to; ++i) {
    votes[i] = static_cast<std::uint16_t>(votes[i] +
                                          (scratch[i - stride] | scratch[i] | scratch[i + stride]));
  }
}

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
