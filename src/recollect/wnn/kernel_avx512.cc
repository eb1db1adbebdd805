// The search with AVX-512 VPOPCNTDQ: eight frames an instruction.
#if defined(__x86_64__)
// g++ 12 takes the undefined registers of its own intrinsics for a mistake of ours.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Wuninitialized"
#include <immintrin.h>

#include <array>
#include <bit>
#include <cstring>

#include "recollect/wnn/kernel_common.h"

#define AVX512 \
  __attribute__((target("avx512f,avx512bw,avx512vl,avx512vpopcntdq,avx512vbmi,gfni,popcnt,bmi")))

namespace recollect::wnn {
namespace {

constexpr int kLane = 8;  // frames a register

AVX512 inline __m512i Load(const std::uint64_t* words) { return _mm512_loadu_si512(words); }

AVX512 inline __m512i Same(std::uint64_t word) {
  return _mm512_set1_epi64(static_cast<long long>(word));
}

AVX512 inline __m512i Different(__m512i words, __m512i query) {
  return _mm512_popcnt_epi64(_mm512_xor_si512(words, query));
}

AVX512 inline __m512i Limit(Answer best) { return _mm512_set1_epi64(AnswerDistance(best)); }

// Squares of 8 x 8 bits, eight a register: rows become columns of bytes, bytes are turned bit by
// bit, and unpacking puts the eight registers' bytes side by side.
AVX512 void Turn(const std::uint8_t* packed, const std::int32_t* at, std::ptrdiff_t moved,
                 int count, std::uint64_t* words) {
  // Byte b of row r goes to row b, byte 7 - r: the matrices of gf2p8affineqb are upside down.
  alignas(64) static constexpr auto kAcross = [] {
    std::array<std::uint8_t, 64> from{};
    for (std::size_t i = 0; i < 64; ++i)
      from[i] = static_cast<std::uint8_t>(8 * (7 - i % 8) + i / 8);
    return from;
  }();
  // Of 64 columns, those that unpacking brings to the places of the first 64 words.
  alignas(64) static constexpr auto kColumns = [] {
    std::array<std::uint8_t, 64> from{};
    for (std::size_t i = 0; i < 64; ++i) {
      from[i] = static_cast<std::uint8_t>(8 * (i % 16 / 2) + 2 * (i / 16) + i % 2);
    }
    return from;
  }();
  const __m512i across = _mm512_load_si512(kAcross.data());
  const __m512i columns = _mm512_load_si512(kColumns.data());
  const __m512i unit = _mm512_set1_epi64(static_cast<long long>(0x8040201008040201ULL));
  const auto word = [&](int i) AVX512 {
    long long read;
    std::memcpy(&read, packed + ((at[i] + moved) >> 3), sizeof read);
    return read;
  };
  const __m512i by = _mm512_set1_epi64(moved), seven = _mm512_set1_epi64(7);
  __m512i rows[8], pairs[8], fours[8];
  for (int i = 0; i < 8; ++i) {
    const int r = 8 * i;  // one by one: faster than a gather
    const __m512i read = _mm512_set_epi64(word(r + 7), word(r + 6), word(r + 5), word(r + 4),
                                          word(r + 3), word(r + 2), word(r + 1), word(r));
    const __m512i places =
        _mm512_cvtepi32_epi64(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(at + r)));
    const __m512i eight =
        _mm512_srlv_epi64(read, _mm512_and_si512(_mm512_add_epi64(places, by), seven));
    const __m512i turned =
        _mm512_gf2p8affine_epi64_epi8(unit, _mm512_permutexvar_epi8(across, eight), 0);
    rows[i] = _mm512_permutexvar_epi8(columns, turned);
  }
  for (int i = 0; i < 4; ++i) {
    pairs[i] = _mm512_unpacklo_epi8(rows[2 * i], rows[2 * i + 1]);
    pairs[4 + i] = _mm512_unpackhi_epi8(rows[2 * i], rows[2 * i + 1]);
  }
  for (int i = 0; i < 8; i += 4) {
    for (int j = 0; j < 2; ++j) {
      fours[i + j] = _mm512_unpacklo_epi16(pairs[i + 2 * j], pairs[i + 2 * j + 1]);
      fours[i + 2 + j] = _mm512_unpackhi_epi16(pairs[i + 2 * j], pairs[i + 2 * j + 1]);
    }
  }
  for (int i = 0; i < 8 && 8 * i < count; ++i) {
    const __m512i low = fours[i / 2 * 2], high = fours[i / 2 * 2 + 1];
    const __m512i eight =
        i % 2 ? _mm512_unpackhi_epi32(low, high) : _mm512_unpacklo_epi32(low, high);
    const int left = count - 8 * i;
    _mm512_mask_storeu_epi64(words + 8 * i,
                             static_cast<__mmask8>(left >= 8 ? 0xff : (1 << left) - 1), eight);
  }
}

AVX512 void Cells(const std::int32_t* values, const std::int32_t* offsets, int begin, int end,
                  std::uint64_t* pattern) {
  constexpr int kGathers = kSynapses / 16;
  for (int n = begin; n < end; ++n) {
    const std::int32_t* offset = offsets + std::ptrdiff_t{n} * kSynapses;
    __m512i value[kGathers + 1];
    for (int i = 0; i < kGathers; ++i) {
      value[i] = _mm512_i32gather_epi32(_mm512_loadu_si512(offset + 16 * i), values, 4);
    }
    value[kGathers] = value[0];
    std::uint64_t words[kWords] = {};
    for (int i = 0; i < kGathers; ++i) {
      const __m512i next = _mm512_alignr_epi32(value[i + 1], value[i], 1);
      words[i / 4] |= std::uint64_t{_mm512_cmplt_epi32_mask(value[i], next)} << (16 * (i % 4));
    }
    for (int w = 0; w < kWords; ++w) pattern[std::ptrdiff_t{n} * kWords + w] = words[w];
  }
}

// Hits are rare: each improves the answer or ties with it.
AVX512 Answer TakeHits(__mmask8 hits, __m512i distances, const TieBreak& ties, int neuron,
                       int first_entry, Answer best) {
  alignas(64) std::uint64_t distance[kLane];
  _mm512_store_si512(distance, distances);
  for (unsigned left = hits; left != 0; left &= left - 1) {
    const int i = std::countr_zero(left);
    best = Better(best, ties, neuron, static_cast<int>(distance[i]), first_entry + i);
  }
  return best;
}

// The Gaussian half first: it tells places apart better. Whatever is further than the best by
// that half alone needs no second look.
AVX512 std::int64_t Scan(const ScanBlock& block, const ScanQuery& query, int begin, int end) {
  std::int64_t lines = 0;
  const int lanes = (64 - std::countl_zero(block.allowed | 1) + kLane - 1) / kLane;
  for (int n = begin; n < end; ++n) {
    const std::uint64_t* low = block.low + std::ptrdiff_t{n} * block.capacity;
    const std::uint64_t* high = block.high + std::ptrdiff_t{n} * block.capacity;
    const __m512i q0 = _mm512_set1_epi64(static_cast<long long>(query.pattern[n * kWords]));
    const __m512i q1 = _mm512_set1_epi64(static_cast<long long>(query.pattern[n * kWords + 1]));
    Answer best = query.answers[n];
    __m512i limit = Limit(best);
    for (int lane = 0; lane < lanes; ++lane) {
      const auto allowed = static_cast<__mmask8>(block.allowed >> (kLane * lane));
      if (allowed == 0) continue;
      ++lines;
      const __m512i half = Different(Load(high + kLane * lane), q1);
      if (_mm512_mask_cmple_epu64_mask(allowed, half, limit) == 0) continue;
      ++lines;
      const __m512i distances = _mm512_add_epi64(half, Different(Load(low + kLane * lane), q0));
      const __mmask8 hits = _mm512_mask_cmple_epu64_mask(allowed, distances, limit);
      if (hits == 0) continue;
      best = TakeHits(hits, distances, query.ties, n, block.first_entry + kLane * lane, best);
      limit = Limit(best);
    }
    query.answers[n] = best;
  }
  return lines * kLane;
}

// The same for a row of a full block; no branch but on the number of hits.
AVX512 Answer TakeBatchHits(std::uint64_t hits, const ScanBlock& block, const ScanQuery& query,
                            int n) {
  const std::uint64_t* low = block.low + std::ptrdiff_t{n} * block.capacity;
  const std::uint64_t* high = block.high + std::ptrdiff_t{n} * block.capacity;
  const std::uint64_t* q = query.pattern + std::ptrdiff_t{n} * kWords;
  Answer best = query.answers[n];
  for (; hits != 0; hits &= hits - 1) {
    const int i = std::countr_zero(hits);
    const int distance = std::popcount(low[i] ^ q[0]) + std::popcount(high[i] ^ q[1]);
    if (distance > AnswerDistance(best)) continue;
    best = Better(best, query.ties, n, distance, block.first_entry + i);
  }
  return best;
}

// One row of a full block stays in registers while all queries pass over it.
AVX512 void ScanBatch(const ScanBlock& block, const ScanQuery* queries, int count, int begin,
                      int end) {
  if (block.allowed != ~std::uint64_t{0}) {
    for (int n = begin; n < end; ++n) {
      for (int q = 0; q < count; ++q) Scan(block, queries[q], n, n + 1);
    }
    return;
  }
  constexpr int kLanes = 64 / kLane;
  for (int n = begin; n < end; ++n) {
    const std::uint64_t* low = block.low + std::ptrdiff_t{n} * block.capacity;
    const std::uint64_t* high = block.high + std::ptrdiff_t{n} * block.capacity;
    constexpr std::ptrdiff_t kAhead = 4 * 64;  // words; beyond the block's end it does no harm
    __m512i rows0[kLanes], rows1[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) {
      rows0[lane] = Load(low + kLane * lane);
      rows1[lane] = Load(high + kLane * lane);
      __builtin_prefetch(low + kLane * lane + kAhead);
      __builtin_prefetch(high + kLane * lane + kAhead);
    }
    for (int q = 0; q < count; ++q) {
      const ScanQuery& query = queries[q];
      const __m512i q0 = _mm512_set1_epi64(static_cast<long long>(query.pattern[n * kWords]));
      const __m512i q1 = _mm512_set1_epi64(static_cast<long long>(query.pattern[n * kWords + 1]));
      // Distances fit into 32 bits, of which the upper half is 0 on both sides: the minimum of 32
      // bits does, and costs half of that of 64.
      __m512i least = _mm512_set1_epi64(2 * kSynapses);
      for (int lane = 0; lane < kLanes; ++lane) {
        least = _mm512_min_epu32(
            least, _mm512_add_epi64(Different(rows0[lane], q0), Different(rows1[lane], q1)));
      }
      const __m512i limit = Limit(query.answers[n]);
      if (_mm512_cmple_epu64_mask(least, limit) == 0) continue;
      std::uint64_t hits = 0;
      for (int lane = 0; lane < kLanes; ++lane) {
        const __m512i distances =
            _mm512_add_epi64(Different(rows0[lane], q0), Different(rows1[lane], q1));
        hits |= std::uint64_t{_mm512_cmple_epu64_mask(distances, limit)} << (kLane * lane);
      }
      query.answers[n] = TakeBatchHits(hits, block, query, n);
    }
  }
}

// Half a block's row stays in registers while all displacements pass over it.
AVX512 void ScanDisplaced(const ScanBlock& block, const DisplacedQuery& query, int begin, int end) {
  constexpr int kLanes = 4, kFrames = kLanes * kLane;
  for (int n = begin; n < end; ++n) {
    const NeuronViews views = query.Of(n);
    const std::uint64_t* low = block.low + std::ptrdiff_t{n} * block.capacity;
    const std::uint64_t* high = block.high + std::ptrdiff_t{n} * block.capacity;
    Answer best = query.answers[n];
    for (int first = 0; first < 64 && block.allowed >> first != 0; first += kFrames) {
      __m512i lows[kLanes], highs[kLanes], least[kLanes];
      for (int lane = 0; lane < kLanes; ++lane) {
        const int frame = first + kLane * lane;
        const auto there = static_cast<__mmask8>(frame < block.capacity ? 0xff : 0);
        lows[lane] = _mm512_maskz_loadu_epi64(there, low + frame);
        highs[lane] = _mm512_maskz_loadu_epi64(there, high + frame);
        least[lane] = _mm512_set1_epi64(kSynapses);
      }
      for (int d = 0; d < views.count; ++d) {
        const __m512i q0 = Same(views.low[d]), q1 = Same(views.high[d]);
        for (int lane = 0; lane < kLanes; ++lane) {
          least[lane] = _mm512_min_epu32(
              least[lane], _mm512_add_epi64(Different(lows[lane], q0), Different(highs[lane], q1)));
        }
      }
      for (int lane = 0; lane < kLanes; ++lane) {
        const int frame = first + kLane * lane;
        const auto allowed = static_cast<__mmask8>(block.allowed >> frame);
        const __mmask8 hits = _mm512_mask_cmple_epu64_mask(allowed, least[lane], Limit(best));
        if (hits == 0) continue;
        best = TakeHits(hits, least[lane], query.ties, n, block.first_entry + frame, best);
      }
    }
    query.answers[n] = best;
  }
}

AVX512 void BlurColumns(const BlurTaps& taps, const std::uint8_t* const* rows, int count,
                        std::int16_t* sums) {
  constexpr int kLanes = 32, kParts = 2, kStep = kParts * kLanes;
  int x = 0;
  for (; x + kStep <= count; x += kStep) {
    __m512i sum[kParts];
    for (__m512i& part : sum) part = _mm512_set1_epi16(-0x8000);
    for (int tap = 0; tap < taps.count; ++tap) {
      const __m512i weight = _mm512_set1_epi16(static_cast<short>(taps.weights[tap]));
      for (int i = 0; i < kParts; ++i) {
        const __m512i words = _mm512_cvtepu8_epi16(
            _mm256_loadu_si256(reinterpret_cast<const __m256i*>(rows[tap] + x + kLanes * i)));
        sum[i] = _mm512_add_epi16(sum[i], _mm512_mullo_epi16(words, weight));
      }
    }
    for (int i = 0; i < kParts; ++i) {
      _mm512_storeu_si512(sums + x + kLanes * i, sum[i]);
    }
  }
  PlainBlurColumns(taps, rows, x, count, sums);
}

// Pairs of taps are multiplied and added at once.
AVX512 void BlurRow(const BlurTaps& taps, const std::int16_t* sums, int stride, int count,
                    std::uint8_t* out) {
  constexpr int kLanes = 32, kParts = 2, kStep = kParts * kLanes;
  int x = 0;
  for (; x + kStep <= count; x += kStep) {
    __m512i low[kParts], high[kParts];
    for (int i = 0; i < kParts; ++i) low[i] = high[i] = _mm512_set1_epi32(kBlurOffset);
    for (int tap = 0; tap < taps.count; tap += 2) {
      const __m512i weights = _mm512_set1_epi32(TwoWeights(taps, tap));
      const std::int16_t* const first = sums + x + tap * stride;
      const std::int16_t* const second = tap + 1 < taps.count ? first + stride : first;
      for (int i = 0; i < kParts; ++i) {
        const __m512i a = _mm512_loadu_si512(first + kLanes * i);
        const __m512i b = _mm512_loadu_si512(second + kLanes * i);
        low[i] = _mm512_add_epi32(low[i], _mm512_madd_epi16(_mm512_unpacklo_epi16(a, b), weights));
        high[i] =
            _mm512_add_epi32(high[i], _mm512_madd_epi16(_mm512_unpackhi_epi16(a, b), weights));
      }
    }
    for (int i = 0; i < kParts; ++i) {
      const __m512i whole =
          _mm512_packs_epi32(_mm512_srai_epi32(low[i], 16), _mm512_srai_epi32(high[i], 16));
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(out + x + kLanes * i),
                          _mm512_cvtepi16_epi8(whole));
    }
  }
  PlainBlurRow(taps, sums + x, stride, count - x, out + x);
}

AVX512 void Probe(const ScanEntry& entry, const ScanQuery& query, int begin, int end) {
  ProbeEntry(entry, query, begin, end);
}

// Distances under displacements [d, d + kLane), of which only those of `mask` are there.
AVX512 inline __m512i DistancesUnder(const NeuronViews& views, int d, __mmask8 mask,
                                     const __m512i entry[2]) {
  const __m512i low = _mm512_maskz_loadu_epi64(mask, views.low + d);
  const __m512i high = _mm512_maskz_loadu_epi64(mask, views.high + d);
  return _mm512_add_epi64(Different(low, entry[0]), Different(high, entry[1]));
}

AVX512 bool FindNear(const NeuronViews& views, const std::uint64_t* entry, int limit,
                     std::uint64_t* near) {
  const NeuronViews own = views;  // that no store may touch
  const __m512i words[2] = {_mm512_set1_epi64(static_cast<long long>(entry[0])),
                            _mm512_set1_epi64(static_cast<long long>(entry[1]))};
  const __m512i most = _mm512_set1_epi64(limit);
  std::uint64_t any = 0;
  int d = 0;
  for (; d + 64 <= own.count; d += 64) {
    std::uint64_t bits = 0;
    for (int lane = 0; lane < 64; lane += kLane) {
      const __m512i distances = DistancesUnder(own, d + lane, 0xff, words);
      bits |= std::uint64_t{_mm512_cmple_epi64_mask(distances, most)} << lane;
    }
    near[d / 64] = bits;
    any |= bits;
  }
  if (d == own.count) return any != 0;
  std::uint64_t bits = 0;
  for (int lane = 0; d + lane < own.count; lane += kLane) {
    const int left = own.count - d - lane;
    const auto mask = static_cast<__mmask8>(left >= kLane ? 0xff : (1 << left) - 1);
    const __m512i distances = DistancesUnder(own, d + lane, mask, words);
    bits |= std::uint64_t{_mm512_mask_cmple_epi64_mask(mask, distances, most)} << lane;
  }
  near[d / 64] = bits;
  return (any | bits) != 0;
}

AVX512 void Measure(const NeuronViews& views, const std::uint64_t* low, const std::uint64_t* high,
                    int count, Distances& all, std::uint64_t* least) {
  const NeuronViews own = views;
  __m512i sums = _mm512_setzero_si512(), squares = sums;
  for (int e = 0; e < count; e += kLane) {
    const auto mask = static_cast<__mmask8>(count - e >= kLane ? 0xff : (1 << (count - e)) - 1);
    const __m512i lows = _mm512_maskz_loadu_epi64(mask, low + e);
    const __m512i highs = _mm512_maskz_loadu_epi64(mask, high + e);
    __m512i nearest = _mm512_set1_epi64(-1);
    for (int d = 0; d < own.count; ++d) {
      const __m512i distances =
          _mm512_add_epi64(Different(lows, Same(own.low[d])), Different(highs, Same(own.high[d])));
      nearest = _mm512_min_epu32(nearest, distances);
      sums = _mm512_mask_add_epi64(sums, mask, sums, distances);
      squares =
          _mm512_mask_add_epi64(squares, mask, squares, _mm512_mul_epu32(distances, distances));
    }
    _mm512_mask_storeu_epi64(least + e, mask, nearest);
  }
  all.sum += static_cast<std::uint64_t>(_mm512_reduce_add_epi64(sums));
  all.squares += static_cast<std::uint64_t>(_mm512_reduce_add_epi64(squares));
}

AVX512 void AddVotes(const std::uint64_t* rows, int count, std::int16_t* votes) {
  const __m512i one = _mm512_set1_epi16(1);
  for (int row = 0; row < count; ++row, votes += 64) {
    for (int half = 0; half < 2; ++half) {
      const __m512i before = _mm512_loadu_si512(votes + 32 * half);
      const auto bits = static_cast<__mmask32>(rows[row] >> (32 * half));
      _mm512_storeu_si512(votes + 32 * half, _mm512_mask_add_epi16(before, bits, before, one));
    }
  }
}

constexpr Kernel kKernel = {"avx512", Turn,      Cells,         BlurColumns, BlurRow, Probe,
                            Scan,     ScanBatch, ScanDisplaced, FindNear,    Measure, AddVotes};

}  // namespace

const Kernel* Avx512Kernel() { return &kKernel; }

}  // namespace recollect::wnn
#else
#include "recollect/wnn/kernel.h"

namespace recollect::wnn {
const Kernel* Avx512Kernel() { return nullptr; }
}  // namespace recollect::wnn
#endif
