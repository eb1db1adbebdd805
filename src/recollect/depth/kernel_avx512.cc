// Semi-global matching with AVX-512: 64 costs of pixels or 32 of paths an instruction. What is left
// over at the end of the disparities is masked.
#if defined(__x86_64__)
// g++ 12 takes the undefined registers of its own intrinsics for a mistake of ours.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#include <immintrin.h>

#include <algorithm>
#include <cstddef>

#include "recollect/depth/kernel.h"

#define AVX512 __attribute__((target("avx512f,avx512bw,avx512vl")))

namespace recollect::stereo {
namespace {

constexpr int kLanes = 32;  // of 16 bits

// The lanes that are left of `count`.
inline __mmask32 Words(int count) { return count >= 32 ? ~__mmask32{0} : (1U << count) - 1; }
inline __mmask64 Bytes(int count) {
  return count >= 64 ? ~__mmask64{0} : (__mmask64{1} << count) - 1;
}
AVX512 inline __m512i Load(__mmask32 mask, const std::uint16_t* at) {
  return _mm512_maskz_loadu_epi16(mask, at);
}
AVX512 inline __m512i Word(int value) { return _mm512_set1_epi16(static_cast<short>(value)); }

AVX512 inline __m512i BitCounts(__m512i bytes) {
  const __m512i table =
      _mm512_broadcast_i32x4(_mm_setr_epi8(0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4));
  const __m512i nibble = _mm512_set1_epi8(15);
  const __m512i high = _mm512_and_si512(_mm512_srli_epi16(bytes, 4), nibble);
  return _mm512_add_epi8(_mm512_shuffle_epi8(table, _mm512_and_si512(bytes, nibble)),
                         _mm512_shuffle_epi8(table, high));
}

// Distance of values from ranges.
AVX512 inline __m512i Beyond(__m512i value, __m512i least, __m512i greatest) {
  return _mm512_max_epu8(_mm512_subs_epu8(value, greatest), _mm512_subs_epu8(least, value));
}

AVX512 void Match(const PlaneRows& left, const PlaneRows& right, int width, int disparities,
                  std::uint8_t* costs) {
  for (int x = 0; x < width; ++x, costs += disparities) {
    __m512i l[kPlanes];
    for (std::size_t p = 0; p < kPlanes; ++p) {
      l[p] = _mm512_set1_epi8(static_cast<char>(left[p][x]));
    }
    const int mirrored = width - 1 - x;
    for (int d = 0; d < disparities; d += 64) {
      const __mmask64 mask = Bytes(disparities - d);
      const auto load = [&](std::size_t p) AVX512 {
        return _mm512_maskz_loadu_epi8(mask, right[p] + mirrored + d);
      };
      const __m512i gradient = _mm512_min_epu8(Beyond(l[kGradient], load(kLeast), load(kGreatest)),
                                               Beyond(load(kGradient), l[kLeast], l[kGreatest]));
      const __m512i doubled = _mm512_add_epi8(gradient, gradient);
      __m512i cost = _mm512_add_epi8(doubled, _mm512_add_epi8(doubled, doubled));
      for (std::size_t p = kCensus0; p <= kCensus2; ++p) {
        cost = _mm512_add_epi8(cost, BitCounts(_mm512_xor_si512(l[p], load(p))));
      }
      _mm512_mask_storeu_epi8(costs + d, mask, cost);
    }
  }
}

AVX512 void Slide(const std::uint8_t* enters, const std::uint8_t* leaves, int count,
                  std::uint16_t* sums) {
  for (int i = 0; i < count; i += kLanes) {
    const __mmask32 mask = Words(count - i);
    const __m512i in = _mm512_cvtepu8_epi16(_mm256_maskz_loadu_epi8(mask, enters + i));
    const __m512i out = _mm512_cvtepu8_epi16(_mm256_maskz_loadu_epi8(mask, leaves + i));
    const __m512i sum = _mm512_add_epi16(Load(mask, sums + i), _mm512_sub_epi16(in, out));
    _mm512_mask_storeu_epi16(sums + i, mask, sum);
  }
}

AVX512 void Window(const std::uint16_t* sums, int width, int disparities, std::uint16_t* out) {
  for (int d = 0; d < disparities; d += kLanes) {
    const __mmask32 mask = Words(disparities - d);
    const auto at = [&](int x) AVX512 {
      return Load(mask, sums + std::ptrdiff_t{std::clamp(x, 0, width - 1)} * disparities + d);
    };
    __m512i sum = Word(kSixths / 2);
    for (int x = -kWindowRadius; x < kWindowRadius; ++x) sum = _mm512_add_epi16(sum, at(x));
    for (int x = 0; x < width; ++x) {
      sum = _mm512_add_epi16(sum, at(x + kWindowRadius));
      // n / 6 = n * 43691 / 2^18 for all n below 2^16.
      const __m512i whole = _mm512_srli_epi16(_mm512_mulhi_epu16(sum, Word(43691)), 2);
      _mm512_mask_storeu_epi16(out + std::ptrdiff_t{x} * disparities + d, mask, whole);
      sum = _mm512_sub_epi16(sum, at(x - kWindowRadius));
    }
  }
}

AVX512 inline std::uint16_t Least(__m512i words) {
  const __m256i half =
      _mm256_min_epu16(_mm512_castsi512_si256(words), _mm512_extracti64x4_epi64(words, 1));
  const __m128i quarter =
      _mm_min_epu16(_mm256_castsi256_si128(half), _mm256_extracti128_si256(half, 1));
  return static_cast<std::uint16_t>(_mm_extract_epi16(_mm_minpos_epu16(quarter), 0));
}

struct Path {
  const std::uint16_t* from;
  std::uint16_t* to;
  __m512i least, jump;  // the least of `from`, and that with the large penalty
  __m512i lowest;       // of `to`, so far
};

AVX512 inline Path MakePath(const std::uint16_t* from, std::uint16_t least, std::uint16_t* to,
                            int large_penalty) {
  return {from, to, Word(least), Word(least + large_penalty), Word(0xffff)};
}

AVX512 inline __m512i Step(Path& path, int d, __mmask32 mask, __m512i cost, __m512i small_penalty) {
  const __m512i beside =
      _mm512_min_epu16(Load(mask, path.from + d - 1), Load(mask, path.from + d + 1));
  const __m512i best = _mm512_min_epu16(_mm512_min_epu16(Load(mask, path.from + d), path.jump),
                                        _mm512_adds_epu16(beside, small_penalty));
  const __m512i to = _mm512_add_epi16(cost, _mm512_sub_epi16(best, path.least));
  _mm512_mask_storeu_epi16(path.to + d, mask, to);
  path.lowest = _mm512_mask_min_epu16(path.lowest, mask, path.lowest, to);
  return to;
}

AVX512 void Sweep(const SweepRow& row) {
  const std::ptrdiff_t stride = row.disparities + kSlotPad;
  const __m512i small_penalty = Word(row.small_penalty);
  auto along = row.along;
  std::uint16_t along_least = 0;
  for (int i = 0; i < row.width; ++i) {
    const int x = row.step > 0 ? i : row.width - 1 - i;
    const std::uint16_t* costs = row.costs + std::ptrdiff_t{x} * row.disparities;
    std::uint16_t* sums = row.sums + std::ptrdiff_t{x} * row.disparities;
    const auto path = [&](int k) AVX512 {
      const auto p = static_cast<std::size_t>(k);
      const int from = x + 1 + row.step * (k - 1);
      return MakePath(row.before[p] + stride * from, row.before_least[p][from],
                      row.here[p] + stride * (x + 1), row.large_penalty);
    };
    Path a = path(0), b = path(1), c = path(2);
    Path e = MakePath(along[0], along_least, along[1], row.large_penalty);
    for (int d = 0; d < row.disparities; d += kLanes) {
      const __mmask32 mask = Words(row.disparities - d);
      const __m512i cost = Load(mask, costs + d);
      const __m512i ab = _mm512_add_epi16(Step(a, d, mask, cost, small_penalty),
                                          Step(b, d, mask, cost, small_penalty));
      const __m512i ce = _mm512_add_epi16(Step(c, d, mask, cost, small_penalty),
                                          Step(e, d, mask, cost, small_penalty));
      _mm512_mask_storeu_epi16(sums + d, mask, _mm512_add_epi16(ab, ce));
    }
    row.here_least[0][x + 1] = Least(a.lowest);
    row.here_least[1][x + 1] = Least(b.lowest);
    row.here_least[2][x + 1] = Least(c.lowest);
    along_least = Least(e.lowest);
    std::swap(along[0], along[1]);
  }
}

AVX512 void Winners(std::uint16_t* sums, const std::uint16_t* second, int width, int disparities,
                    std::uint16_t* best, std::uint16_t* right_cost, std::uint16_t* right_best) {
  std::fill_n(right_cost, width + disparities, std::uint16_t{0xffff});
  std::fill_n(right_best, width + disparities, std::uint16_t{0});
  alignas(64) std::uint16_t ramp[kLanes];
  for (int i = 0; i < kLanes; ++i) ramp[i] = static_cast<std::uint16_t>(i);
  const __m512i count = _mm512_load_si512(ramp);
  for (int x = 0; x < width; ++x, sums += disparities, second += disparities) {
    const int mirrored = width - 1 - x;
    __m512i lowest = Word(0xffff), winner = _mm512_setzero_si512();
    for (int d = 0; d < disparities; d += kLanes) {
      const __mmask32 mask = Words(disparities - d);
      const __m512i sum = _mm512_add_epi16(Load(mask, sums + d), Load(mask, second + d));
      _mm512_mask_storeu_epi16(sums + d, mask, sum);
      const __m512i number = _mm512_add_epi16(count, Word(d));
      const __mmask32 lower = _mm512_mask_cmplt_epu16_mask(mask, sum, lowest);
      winner = _mm512_mask_mov_epi16(winner, lower, number);
      lowest = _mm512_mask_mov_epi16(lowest, lower, sum);
      std::uint16_t* cost = right_cost + mirrored + d;
      const __mmask32 cheaper = _mm512_mask_cmplt_epu16_mask(mask, sum, Load(mask, cost));
      _mm512_mask_storeu_epi16(cost, cheaper, sum);
      _mm512_mask_storeu_epi16(right_best + mirrored + d, cheaper, number);
    }
    const __mmask32 wins = _mm512_cmpeq_epi16_mask(lowest, Word(Least(lowest)));
    best[x] = Least(_mm512_mask_mov_epi16(Word(0xffff), wins, winner));
  }
}

constexpr Kernel kKernel = {"avx512", Match, Slide, Window, Sweep, Winners};

}  // namespace

const Kernel* Avx512Kernel() { return &kKernel; }

}  // namespace recollect::stereo
#else
#include "recollect/depth/kernel.h"

namespace recollect::stereo {
const Kernel* Avx512Kernel() { return nullptr; }
}  // namespace recollect::stereo
#endif
