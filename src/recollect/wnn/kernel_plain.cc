// The search in plain C++: what the other kernels are tested against.
#include <bit>

#include "recollect/wnn/bit_square.h"
#include "recollect/wnn/kernel_common.h"

namespace recollect::wnn {

void PlainCells(const std::int32_t* values, const std::int32_t* offsets, int begin, int end,
                std::uint64_t* pattern) {
  for (int n = begin; n < end; ++n) {
    const std::int32_t* offset = offsets + std::ptrdiff_t{n} * kSynapses;
    std::int32_t value[kSynapses + 1];
    for (int i = 0; i < kSynapses; ++i) value[i] = values[offset[i]];
    value[kSynapses] = value[0];
    for (int w = 0; w < kWords; ++w) {
      std::uint64_t word = 0;
      for (int i = 0; i < 64; ++i) {
        word |= std::uint64_t{value[64 * w + i] < value[64 * w + i + 1]} << i;
      }
      pattern[std::ptrdiff_t{n} * kWords + w] = word;
    }
  }
}

void PlainBlurColumns(const BlurTaps& taps, const std::uint8_t* const* rows, int begin, int count,
                      std::int16_t* sums) {
  for (int x = begin; x < count; ++x) {
    int sum = 0;
    for (int tap = 0; tap < taps.count; ++tap) sum += rows[tap][x] * taps.weights[tap];
    sums[x] = static_cast<std::int16_t>(sum - kBlurBias);
  }
}

void PlainBlurRow(const BlurTaps& taps, const std::int16_t* sums, int stride, int count,
                  std::uint8_t* out) {
  for (int x = 0; x < count; ++x) {
    int sum = kBlurOffset;
    for (int tap = 0; tap < taps.count; ++tap) sum += sums[x + tap * stride] * taps.weights[tap];
    out[x] = static_cast<std::uint8_t>(sum >> 16);
  }
}

bool PlainFindNear(const NeuronViews& views, const std::uint64_t* entry, int limit,
                   std::uint64_t* near) {
  return FindNearOf(views, entry, limit, near);
}

void PlainMeasure(const NeuronViews& views, const std::uint64_t* low, const std::uint64_t* high,
                  int count, Distances& all, std::uint64_t* least) {
  MeasureOf(views, low, high, count, all, least);
}

void PlainScanDisplaced(const ScanBlock& block, const DisplacedQuery& query, int begin, int end) {
  ScanDisplacedOf(block, query, begin, end);
}

namespace {

std::int64_t Scan(const ScanBlock& block, const ScanQuery& query, int begin, int end) {
  std::int64_t read = 0;
  for (int n = begin; n < end; ++n) {
    const std::uint64_t* low = block.low + std::ptrdiff_t{n} * block.capacity;
    const std::uint64_t* high = block.high + std::ptrdiff_t{n} * block.capacity;
    const std::uint64_t* q = query.pattern + std::ptrdiff_t{n} * kWords;
    Answer best = query.answers[n];
    for (std::uint64_t left = block.allowed; left != 0; left &= left - 1) {
      const int i = std::countr_zero(left);
      const int distance = std::popcount(low[i] ^ q[0]) + std::popcount(high[i] ^ q[1]);
      if (distance <= AnswerDistance(best)) {
        best = Better(best, query.ties, n, distance, block.first_entry + i);
      }
      read += kWords;
    }
    query.answers[n] = best;
  }
  return read;
}

void ScanBatch(const ScanBlock& block, const ScanQuery* queries, int count, int begin, int end) {
  for (int n = begin; n < end; ++n) {
    for (int q = 0; q < count; ++q) Scan(block, queries[q], n, n + 1);
  }
}

void BlurColumns(const BlurTaps& taps, const std::uint8_t* const* rows, int count,
                 std::int16_t* sums) {
  PlainBlurColumns(taps, rows, 0, count, sums);
}

void Probe(const ScanEntry& entry, const ScanQuery& query, int begin, int end) {
  ProbeEntry(entry, query, begin, end);
}

}  // namespace

const Kernel kPlainKernel = {
    "plain", PlainTurn, PlainCells,         BlurColumns,   PlainBlurRow, Probe,
    Scan,    ScanBatch, PlainScanDisplaced, PlainFindNear, PlainMeasure, PlainAddVotes};

}  // namespace recollect::wnn
