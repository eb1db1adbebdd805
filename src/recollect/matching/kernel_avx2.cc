// Inner products of descriptors with AVX2: 32 products of bytes an instruction, added in pairs of
// 16 bits (2 * 127 * 127 fits), four descriptors against sixteen at a time.
#include "recollect/matching/kernel.h"

#if defined(__x86_64__)
#include <immintrin.h>

#include <cstring>

namespace recollect::matching {
namespace {

#define AVX2 __attribute__((target("avx2")))

constexpr int kRows = 4;
constexpr std::ptrdiff_t kGroupBytes = PackedDescriptors::kSide * kDescriptorBytes;

template <int rows>
AVX2 void Block(const std::int8_t* descriptors, const std::int8_t* packed, int groups, int* out) {
  const __m256i ones = _mm256_set1_epi16(1);
  for (int g = 0; g < groups; ++g) {
    const std::int8_t* at = packed + g * kGroupBytes;
    __m256i low[rows], high[rows];
    for (int r = 0; r < rows; ++r) low[r] = high[r] = _mm256_setzero_si256();
    for (int quad = 0; quad < kDescriptorBytes; quad += 4, at += 64) {
      const auto* halves = reinterpret_cast<const __m256i*>(at);
      const __m256i first = _mm256_loadu_si256(halves), second = _mm256_loadu_si256(halves + 1);
      for (int r = 0; r < rows; ++r) {
        int four;
        std::memcpy(&four, descriptors + r * kDescriptorBytes + quad, 4);
        const __m256i own = _mm256_set1_epi32(four);
        low[r] =
            _mm256_add_epi32(low[r], _mm256_madd_epi16(_mm256_maddubs_epi16(first, own), ones));
        high[r] =
            _mm256_add_epi32(high[r], _mm256_madd_epi16(_mm256_maddubs_epi16(second, own), ones));
      }
    }
    for (int r = 0; r < rows; ++r) {
      auto* to = reinterpret_cast<__m256i*>(out + (r * groups + g) * PackedDescriptors::kSide);
      _mm256_storeu_si256(to, low[r]);
      _mm256_storeu_si256(to + 1, high[r]);
    }
  }
}

void Products(const std::int8_t* descriptors, int rows, const std::int8_t* packed, int groups,
              int* out) {
  if (rows == kRows) return Block<kRows>(descriptors, packed, groups, out);
  for (int r = 0; r < rows; ++r) {
    Block<1>(descriptors + r * kDescriptorBytes, packed, groups,
             out + r * groups * PackedDescriptors::kSide);
  }
}

constexpr Kernel kKernel = {"avx2", kRows, Products};

}  // namespace

const Kernel* Avx2Kernel() { return &kKernel; }

}  // namespace recollect::matching
#else
namespace recollect::matching {
const Kernel* Avx2Kernel() { return nullptr; }
}  // namespace recollect::matching
#endif
