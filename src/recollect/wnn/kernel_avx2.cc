// The search with AVX2: four frames an instruction, bits counted by table (Mula's method).
#if defined(__x86_64__)
#include <immintrin.h>

#include <bit>

#include "recollect/wnn/bit_square.h"
#include "recollect/wnn/kernel_common.h"

#define AVX2 __attribute__((target("avx2,popcnt,bmi")))

namespace recollect::wnn {
namespace {

constexpr int kLane = 4;  // frames a register

// Bits set in each byte.
AVX2 inline __m256i ByteCounts(__m256i words) {
  const __m256i table = _mm256_setr_epi8(0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4,  //
                                         0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4);
  const __m256i nibble = _mm256_set1_epi8(15);
  const __m256i low = _mm256_and_si256(words, nibble);
  const __m256i high = _mm256_and_si256(_mm256_srli_epi16(words, 4), nibble);
  return _mm256_add_epi8(_mm256_shuffle_epi8(table, low), _mm256_shuffle_epi8(table, high));
}

AVX2 inline __m256i Different(const std::uint64_t* words, __m256i query) {
  const __m256i row = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(words));
  return ByteCounts(_mm256_xor_si256(row, query));
}

// One bit a frame of four: distance <= limit.
AVX2 inline unsigned AtMost(__m256i distances, __m256i limit) {
  const __m256i above = _mm256_cmpgt_epi64(distances, limit);
  return ~static_cast<unsigned>(_mm256_movemask_pd(_mm256_castsi256_pd(above))) & 15;
}

AVX2 inline __m256i Sum(__m256i bytes) { return _mm256_sad_epu8(bytes, _mm256_setzero_si256()); }

AVX2 inline __m256i Limit(Answer best) { return _mm256_set1_epi64x(AnswerDistance(best)); }

AVX2 void Cells(const std::int32_t* values, const std::int32_t* offsets, int begin, int end,
                std::uint64_t* pattern) {
  constexpr int kGathers = kSynapses / 8;
  const __m256i rotate = _mm256_setr_epi32(1, 2, 3, 4, 5, 6, 7, 0);
  for (int n = begin; n < end; ++n) {
    const std::int32_t* offset = offsets + std::ptrdiff_t{n} * kSynapses;
    __m256i value[kGathers + 1];
    for (int i = 0; i < kGathers; ++i) {
      const auto* at = reinterpret_cast<const __m256i*>(offset + 8 * i);
      value[i] = _mm256_i32gather_epi32(values, _mm256_loadu_si256(at), 4);
    }
    value[kGathers] = value[0];
    std::uint64_t words[kWords] = {};
    for (int i = 0; i < kGathers; ++i) {
      const __m256i next =
          _mm256_permutevar8x32_epi32(_mm256_blend_epi32(value[i], value[i + 1], 1), rotate);
      const __m256i below = _mm256_cmpgt_epi32(next, value[i]);
      const auto bits = static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(below)));
      words[i / 8] |= std::uint64_t{bits} << (8 * (i % 8));
    }
    for (int w = 0; w < kWords; ++w) pattern[std::ptrdiff_t{n} * kWords + w] = words[w];
  }
}

AVX2 Answer TakeHits(unsigned hits, __m256i distances, const TieBreak& ties, int neuron,
                     int first_entry, Answer best) {
  alignas(32) std::uint64_t distance[kLane];
  _mm256_store_si256(reinterpret_cast<__m256i*>(distance), distances);
  for (; hits != 0; hits &= hits - 1) {
    const int i = std::countr_zero(hits);
    best = Better(best, ties, neuron, static_cast<int>(distance[i]), first_entry + i);
  }
  return best;
}

AVX2 std::int64_t Scan(const ScanBlock& block, const ScanQuery& query, int begin, int end) {
  std::int64_t quarters = 0;
  const int lanes = (64 - std::countl_zero(block.allowed | 1) + kLane - 1) / kLane;
  for (int n = begin; n < end; ++n) {
    const std::uint64_t* low = block.low + std::ptrdiff_t{n} * block.capacity;
    const std::uint64_t* high = block.high + std::ptrdiff_t{n} * block.capacity;
    const __m256i q0 = _mm256_set1_epi64x(static_cast<long long>(query.pattern[n * kWords]));
    const __m256i q1 = _mm256_set1_epi64x(static_cast<long long>(query.pattern[n * kWords + 1]));
    Answer best = query.answers[n];
    __m256i limit = Limit(best);
    for (int lane = 0; lane < lanes; ++lane) {
      const auto allowed = static_cast<unsigned>(block.allowed >> (kLane * lane)) & 15;
      if (allowed == 0) continue;
      ++quarters;
      const __m256i half = Different(high + kLane * lane, q1);
      if ((AtMost(Sum(half), limit) & allowed) == 0) continue;
      ++quarters;
      const __m256i distances = Sum(_mm256_add_epi8(half, Different(low + kLane * lane, q0)));
      const unsigned hits = AtMost(distances, limit) & allowed;
      if (hits == 0) continue;
      best = TakeHits(hits, distances, query.ties, n, block.first_entry + kLane * lane, best);
      limit = Limit(best);
    }
    query.answers[n] = best;
  }
  return quarters * kLane;
}

AVX2 void ScanBatch(const ScanBlock& block, const ScanQuery* queries, int count, int begin,
                    int end) {
  for (int n = begin; n < end; ++n) {
    for (int q = 0; q < count; ++q) Scan(block, queries[q], n, n + 1);
  }
}

AVX2 void BlurColumns(const BlurTaps& taps, const std::uint8_t* const* rows, int count,
                      std::int16_t* sums) {
  constexpr int kLanes = 16, kParts = 2, kStep = kParts * kLanes;
  int x = 0;
  for (; x + kStep <= count; x += kStep) {
    __m256i sum[kParts];
    for (__m256i& part : sum) part = _mm256_set1_epi16(-0x8000);
    for (int tap = 0; tap < taps.count; ++tap) {
      const __m256i weight = _mm256_set1_epi16(static_cast<short>(taps.weights[tap]));
      for (int i = 0; i < kParts; ++i) {
        const __m256i words = _mm256_cvtepu8_epi16(
            _mm_loadu_si128(reinterpret_cast<const __m128i*>(rows[tap] + x + kLanes * i)));
        sum[i] = _mm256_add_epi16(sum[i], _mm256_mullo_epi16(words, weight));
      }
    }
    for (int i = 0; i < kParts; ++i) {
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(sums + x + kLanes * i), sum[i]);
    }
  }
  PlainBlurColumns(taps, rows, x, count, sums);
}

// Pairs of taps are multiplied and added at once.
AVX2 void BlurRow(const BlurTaps& taps, const std::int16_t* sums, int stride, int count,
                  std::uint8_t* out) {
  constexpr int kLanes = 16, kParts = 2, kStep = kParts * kLanes;
  int x = 0;
  for (; x + kStep <= count; x += kStep) {
    __m256i low[kParts], high[kParts];
    for (int i = 0; i < kParts; ++i) low[i] = high[i] = _mm256_set1_epi32(kBlurOffset);
    for (int tap = 0; tap < taps.count; tap += 2) {
      const __m256i weights = _mm256_set1_epi32(TwoWeights(taps, tap));
      const std::int16_t* const first = sums + x + tap * stride;
      const std::int16_t* const second = tap + 1 < taps.count ? first + stride : first;
      for (int i = 0; i < kParts; ++i) {
        const __m256i a = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(first + kLanes * i));
        const __m256i b = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(second + kLanes * i));
        low[i] = _mm256_add_epi32(low[i], _mm256_madd_epi16(_mm256_unpacklo_epi16(a, b), weights));
        high[i] =
            _mm256_add_epi32(high[i], _mm256_madd_epi16(_mm256_unpackhi_epi16(a, b), weights));
      }
    }
    for (int i = 0; i < kParts; ++i) {
      const __m256i whole =
          _mm256_packs_epi32(_mm256_srai_epi32(low[i], 16), _mm256_srai_epi32(high[i], 16));
      const __m256i bytes = _mm256_permute4x64_epi64(_mm256_packus_epi16(whole, whole), 0x08);
      _mm_storeu_si128(reinterpret_cast<__m128i*>(out + x + kLanes * i),
                       _mm256_castsi256_si128(bytes));
    }
  }
  PlainBlurRow(taps, sums + x, stride, count - x, out + x);
}

AVX2 void Probe(const ScanEntry& entry, const ScanQuery& query, int begin, int end) {
  ProbeEntry(entry, query, begin, end);
}

AVX2 bool FindNear(const NeuronViews& views, const std::uint64_t* entry, int limit,
                   std::uint64_t* near) {
  return FindNearOf(views, entry, limit, near);
}

AVX2 void Measure(const NeuronViews& views, const std::uint64_t* low, const std::uint64_t* high,
                  int count, Distances& all, std::uint64_t* least) {
  MeasureOf(views, low, high, count, all, least);
}

AVX2 void ScanDisplaced(const ScanBlock& block, const DisplacedQuery& query, int begin, int end) {
  ScanDisplacedOf(block, query, begin, end);
}

constexpr Kernel kKernel = {"avx2", PlainTurn, Cells,         BlurColumns, BlurRow, Probe,
                            Scan,   ScanBatch, ScanDisplaced, FindNear,    Measure, PlainAddVotes};

}  // namespace

const Kernel* Avx2Kernel() { return &kKernel; }

}  // namespace recollect::wnn
#else
#include "recollect/wnn/kernel.h"

namespace recollect::wnn {
const Kernel* Avx2Kernel() { return nullptr; }
}  // namespace recollect::wnn
#endif
