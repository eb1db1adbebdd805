// Inner products of descriptors with AVX-512 VNNI: 64 products of bytes an instruction, eight
// descriptors against sixteen at a time, so that each load serves eight sums.
#include "recollect/matching/kernel.h"

#if defined(__x86_64__)
// g++ 12 takes the undefined registers of its own intrinsics for a mistake of ours.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#include <immintrin.h>

#include <cstring>

namespace recollect::matching {
namespace {

#define AVX512 __attribute__((target("avx512f,avx512bw,avx512vl,avx512vnni")))

constexpr int kRows = 8;
constexpr std::ptrdiff_t kGroupBytes = PackedDescriptors::kSide * kDescriptorBytes;

template <int rows>
AVX512 void Block(const std::int8_t* descriptors, const std::int8_t* packed, int groups, int* out) {
  for (int g = 0; g < groups; ++g) {
    const std::int8_t* at = packed + g * kGroupBytes;
    __m512i sums[rows];
    for (int r = 0; r < rows; ++r) sums[r] = _mm512_setzero_si512();
    for (int quad = 0; quad < kDescriptorBytes; quad += 4, at += 64) {
      const __m512i bytes = _mm512_loadu_si512(at);
      for (int r = 0; r < rows; ++r) {
        int four;
        std::memcpy(&four, descriptors + r * kDescriptorBytes + quad, 4);
        sums[r] = _mm512_dpbusd_epi32(sums[r], bytes, _mm512_set1_epi32(four));
      }
    }
    for (int r = 0; r < rows; ++r) {
      _mm512_storeu_si512(out + (r * groups + g) * PackedDescriptors::kSide, sums[r]);
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

constexpr Kernel kKernel = {"avx512", kRows, Products};

}  // namespace

const Kernel* Avx512VnniKernel() { return &kKernel; }

}  // namespace recollect::matching
#else
namespace recollect::matching {
const Kernel* Avx512VnniKernel() { return nullptr; }
}  // namespace recollect::matching
#endif
