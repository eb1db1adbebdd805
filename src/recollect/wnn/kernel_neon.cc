// The search with NEON: two frames an instruction.
#if defined(__aarch64__)
#include <arm_neon.h>

#include <bit>

#include "recollect/wnn/bit_square.h"
#include "recollect/wnn/kernel_common.h"

namespace recollect::wnn {
namespace {

constexpr int kLane = 2;  // frames a register

inline uint8x16_t Different(const std::uint64_t* words, uint64x2_t query) {
  return vcntq_u8(vreinterpretq_u8_u64(veorq_u64(vld1q_u64(words), query)));
}

inline uint64x2_t Sum(uint8x16_t bytes) { return vpaddlq_u32(vpaddlq_u16(vpaddlq_u8(bytes))); }

inline bool AnyAtMost(uint64x2_t distances, uint64x2_t limit) {
  return vmaxvq_u32(vreinterpretq_u32_u64(vcleq_u64(distances, limit))) != 0;
}

inline uint64x2_t Limit(Answer best) {
  return vdupq_n_u64(static_cast<std::uint64_t>(AnswerDistance(best)));
}

std::int64_t Scan(const ScanBlock& block, const ScanQuery& query, int begin, int end) {
  std::int64_t pairs = 0;
  const int lanes = (64 - std::countl_zero(block.allowed | 1) + kLane - 1) / kLane;
  for (int n = begin; n < end; ++n) {
    const std::uint64_t* low = block.low + std::ptrdiff_t{n} * block.capacity;
    const std::uint64_t* high = block.high + std::ptrdiff_t{n} * block.capacity;
    const uint64x2_t q0 = vdupq_n_u64(query.pattern[n * kWords]);
    const uint64x2_t q1 = vdupq_n_u64(query.pattern[n * kWords + 1]);
    Answer best = query.answers[n];
    uint64x2_t limit = Limit(best);
    for (int lane = 0; lane < lanes; ++lane) {
      const unsigned allowed = static_cast<unsigned>(block.allowed >> (kLane * lane)) & 3;
      if (allowed == 0) continue;
      ++pairs;
      const uint8x16_t half = Different(high + kLane * lane, q1);
      if (!AnyAtMost(Sum(half), limit)) continue;
      ++pairs;
      const uint64x2_t sums = Sum(vaddq_u8(half, Different(low + kLane * lane, q0)));
      if (!AnyAtMost(sums, limit)) continue;
      const std::uint64_t distance[kLane] = {vgetq_lane_u64(sums, 0), vgetq_lane_u64(sums, 1)};
      for (unsigned left = allowed; left != 0; left &= left - 1) {
        const int i = std::countr_zero(left);
        if (static_cast<int>(distance[i]) > AnswerDistance(best)) continue;
        best = Better(best, query.ties, n, static_cast<int>(distance[i]),
                      block.first_entry + kLane * lane + i);
      }
      limit = Limit(best);
    }
    query.answers[n] = best;
  }
  return pairs * kLane;
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

constexpr Kernel kKernel = {
    "neon", PlainTurn, PlainCells,         BlurColumns,   PlainBlurRow, Probe,
    Scan,   ScanBatch, PlainScanDisplaced, PlainFindNear, PlainMeasure, PlainAddVotes};

}  // namespace

const Kernel* NeonKernel() { return &kKernel; }

}  // namespace recollect::wnn
#else
#include "recollect/wnn/kernel.h"

namespace recollect::wnn {
const Kernel* NeonKernel() { return nullptr; }
}  // namespace recollect::wnn
#endif
