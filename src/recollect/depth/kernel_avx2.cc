// Semi-global matching with AVX2: 32 costs of pixels or 16 of paths an instruction.
#if defined(__x86_64__)
#include <immintrin.h>

#include <algorithm>
#include <cstddef>

#include "recollect/depth/kernel.h"

#define AVX2 __attribute__((target("avx2")))

namespace recollect::stereo {
namespace {

constexpr int kLanes = 16;  // of 16 bits

AVX2 inline __m256i Load(const void* at) {
  return _mm256_loadu_si256(static_cast<const __m256i*>(at));
}
AVX2 inline void Store(void* at, __m256i value) {
  _mm256_storeu_si256(static_cast<__m256i*>(at), value);
}
AVX2 inline __m256i Word(int value) { return _mm256_set1_epi16(static_cast<short>(value)); }
AVX2 inline __m256i Byte(std::uint8_t value) { return _mm256_set1_epi8(static_cast<char>(value)); }

AVX2 inline __m256i BitCounts(__m256i bytes) {
  const __m256i table = _mm256_setr_epi8(0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4,  //
                                         0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4);
  const __m256i nibble = _mm256_set1_epi8(15);
  const __m256i high = _mm256_and_si256(_mm256_srli_epi16(bytes, 4), nibble);
  return _mm256_add_epi8(_mm256_shuffle_epi8(table, _mm256_and_si256(bytes, nibble)),
                         _mm256_shuffle_epi8(table, high));
}

// Distance of values from ranges.
AVX2 inline __m256i Beyond(__m256i value, __m256i least, __m256i greatest) {
  return _mm256_max_epu8(_mm256_subs_epu8(value, greatest), _mm256_subs_epu8(least, value));
}

AVX2 void Match(const PlaneRows& left, const PlaneRows& right, int width, int disparities,
                std::uint8_t* costs) {
  for (int x = 0; x < width; ++x, costs += disparities) {
    __m256i l[kPlanes];
    for (std::size_t p = 0; p < kPlanes; ++p) l[p] = Byte(left[p][x]);
    const int mirrored = width - 1 - x;
    // A last half register is computed again together with the half before it; where there is none
    // before it, its upper half is computed and not stored.
    for (int d = 0; d < disparities; d += 32) {
      const bool half = d + 32 > disparities;
      const auto load = [&](std::size_t p) AVX2 {
        const std::uint8_t* at = right[p] + mirrored + d;
        return half ? _mm256_castsi128_si256(_mm_loadu_si128(reinterpret_cast<const __m128i*>(at)))
                    : Load(at);
      };
      const __m256i gradient = _mm256_min_epu8(Beyond(l[kGradient], load(kLeast), load(kGreatest)),
                                               Beyond(load(kGradient), l[kLeast], l[kGreatest]));
      const __m256i doubled = _mm256_add_epi8(gradient, gradient);
      __m256i cost = _mm256_add_epi8(doubled, _mm256_add_epi8(doubled, doubled));
      for (std::size_t p = kCensus0; p <= kCensus2; ++p) {
        cost = _mm256_add_epi8(cost, BitCounts(_mm256_xor_si256(l[p], load(p))));
      }
      if (half) {
        _mm_storeu_si128(reinterpret_cast<__m128i*>(costs + d), _mm256_castsi256_si128(cost));
      } else {
        Store(costs + d, cost);
      }
    }
  }
}

AVX2 inline __m256i Widened(const std::uint8_t* at) {
  return _mm256_cvtepu8_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(at)));
}

AVX2 void Slide(const std::uint8_t* enters, const std::uint8_t* leaves, int count,
                std::uint16_t* sums) {
  for (int i = 0; i < count; i += kLanes) {
    const __m256i change = _mm256_sub_epi16(Widened(enters + i), Widened(leaves + i));
    Store(sums + i, _mm256_add_epi16(Load(sums + i), change));
  }
}

AVX2 void Window(const std::uint16_t* sums, int width, int disparities, std::uint16_t* out) {
  for (int d = 0; d < disparities; d += kLanes) {
    const auto at = [&](int x) AVX2 {
      return Load(sums + std::ptrdiff_t{std::clamp(x, 0, width - 1)} * disparities + d);
    };
    __m256i sum = Word(kSixths / 2);
    for (int x = -kWindowRadius; x < kWindowRadius; ++x) sum = _mm256_add_epi16(sum, at(x));
    for (int x = 0; x < width; ++x) {
      sum = _mm256_add_epi16(sum, at(x + kWindowRadius));
      // n / 6 = n * 43691 / 2^18 for all n below 2^16.
      const __m256i whole = _mm256_srli_epi16(_mm256_mulhi_epu16(sum, Word(43691)), 2);
      Store(out + std::ptrdiff_t{x} * disparities + d, whole);
      sum = _mm256_sub_epi16(sum, at(x - kWindowRadius));
    }
  }
}

AVX2 inline std::uint16_t Least(__m256i words) {
  const __m128i half =
      _mm_min_epu16(_mm256_castsi256_si128(words), _mm256_extracti128_si256(words, 1));
  return static_cast<std::uint16_t>(_mm_extract_epi16(_mm_minpos_epu16(half), 0));
}

struct Path {
  const std::uint16_t* from;
  std::uint16_t* to;
  __m256i least, jump;  // the least of `from`, and that with the large penalty
  __m256i lowest;       // of `to`, so far
};

AVX2 inline Path MakePath(const std::uint16_t* from, std::uint16_t least, std::uint16_t* to,
                          int large_penalty) {
  return {from, to, Word(least), Word(least + large_penalty), Word(0xffff)};
}

AVX2 inline __m256i Step(Path& path, int d, __m256i cost, __m256i small_penalty) {
  const __m256i beside = _mm256_min_epu16(Load(path.from + d - 1), Load(path.from + d + 1));
  const __m256i best = _mm256_min_epu16(_mm256_min_epu16(Load(path.from + d), path.jump),
                                        _mm256_adds_epu16(beside, small_penalty));
  const __m256i to = _mm256_add_epi16(cost, _mm256_sub_epi16(best, path.least));
  Store(path.to + d, to);
  path.lowest = _mm256_min_epu16(path.lowest, to);
  return to;
}

AVX2 void Sweep(const SweepRow& row) {
  const std::ptrdiff_t stride = row.disparities + kSlotPad;
  const __m256i small_penalty = Word(row.small_penalty);
  auto along = row.along;
  std::uint16_t along_least = 0;
  for (int i = 0; i < row.width; ++i) {
    const int x = row.step > 0 ? i : row.width - 1 - i;
    const std::uint16_t* costs = row.costs + std::ptrdiff_t{x} * row.disparities;
    std::uint16_t* sums = row.sums + std::ptrdiff_t{x} * row.disparities;
    const auto path = [&](int k) AVX2 {
      const auto p = static_cast<std::size_t>(k);
      const int from = x + 1 + row.step * (k - 1);
      return MakePath(row.before[p] + stride * from, row.before_least[p][from],
                      row.here[p] + stride * (x + 1), row.large_penalty);
    };
    Path a = path(0), b = path(1), c = path(2);
    Path e = MakePath(along[0], along_least, along[1], row.large_penalty);
    for (int d = 0; d < row.disparities; d += kLanes) {
      const __m256i cost = Load(costs + d);
      const __m256i ab =
          _mm256_add_epi16(Step(a, d, cost, small_penalty), Step(b, d, cost, small_penalty));
      const __m256i ce =
          _mm256_add_epi16(Step(c, d, cost, small_penalty), Step(e, d, cost, small_penalty));
      Store(sums + d, _mm256_add_epi16(ab, ce));
    }
    row.here_least[0][x + 1] = Least(a.lowest);
    row.here_least[1][x + 1] = Least(b.lowest);
    row.here_least[2][x + 1] = Least(c.lowest);
    along_least = Least(e.lowest);
    std::swap(along[0], along[1]);
  }
}

AVX2 void Winners(std::uint16_t* sums, const std::uint16_t* second, int width, int disparities,
                  std::uint16_t* best, std::uint16_t* right_cost, std::uint16_t* right_best) {
  std::fill_n(right_cost, width + disparities, std::uint16_t{0xffff});
  std::fill_n(right_best, width + disparities, std::uint16_t{0});
  const __m256i count = _mm256_setr_epi16(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  for (int x = 0; x < width; ++x, sums += disparities, second += disparities) {
    const int mirrored = width - 1 - x;
    __m256i lowest = Word(0xffff), winner = _mm256_setzero_si256();
    for (int d = 0; d < disparities; d += kLanes) {
      const __m256i sum = _mm256_add_epi16(Load(sums + d), Load(second + d));
      Store(sums + d, sum);
      const __m256i number = _mm256_add_epi16(count, Word(d));
      const __m256i lower = _mm256_min_epu16(lowest, sum);
      winner = _mm256_blendv_epi8(number, winner, _mm256_cmpeq_epi16(lower, lowest));
      lowest = lower;
      std::uint16_t *cost = right_cost + mirrored + d, *number_at = right_best + mirrored + d;
      const __m256i old = Load(cost), least = _mm256_min_epu16(old, sum);
      Store(cost, least);
      Store(number_at, _mm256_blendv_epi8(number, Load(number_at), _mm256_cmpeq_epi16(least, old)));
    }
    const __m256i wins = _mm256_cmpeq_epi16(lowest, Word(Least(lowest)));
    best[x] = Least(_mm256_or_si256(winner, _mm256_xor_si256(wins, Word(0xffff))));
  }
}

constexpr Kernel kKernel = {"avx2", Match, Slide, Window, Sweep, Winners};

}  // namespace

const Kernel* Avx2Kernel() { return &kKernel; }

}  // namespace recollect::stereo
#else
#include "recollect/depth/kernel.h"

namespace recollect::stereo {
const Kernel* Avx2Kernel() { return nullptr; }
}  // namespace recollect::stereo
#endif
