// Vectors of RECOLLECT_LANES numbers for packet_kernel.h. Only operations whose results IEEE 754
// fixes are used, and files that include this are compiled without contraction into fused
// operations: every instruction set gives the same bits.
#include <cstdint>

#include "recollect/simulation/packet.h"

namespace recollect::simulation {
namespace {

constexpr int kLanes = RECOLLECT_LANES;
using Floats = float __attribute__((vector_size(4 * kLanes)));
using Ints = std::int32_t __attribute__((vector_size(4 * kLanes)));
using Words = std::uint32_t __attribute__((vector_size(4 * kLanes)));

#define INLINE __attribute__((always_inline)) inline

INLINE Floats Load(const float* p) {
  Floats r;
  __builtin_memcpy(&r, p, sizeof r);
  return r;
}
INLINE Ints LoadInts(const std::int32_t* p) {
  Ints r;
  __builtin_memcpy(&r, p, sizeof r);
  return r;
}
INLINE void Store(float* p, Floats x) { __builtin_memcpy(p, &x, sizeof x); }
INLINE void Store(std::int32_t* p, Ints x) { __builtin_memcpy(p, &x, sizeof x); }

INLINE Floats All(float x) { return x - Floats{}; }
INLINE Ints AllInts(std::int32_t x) { return x - Ints{}; }
INLINE Floats Max(Floats a, Floats b) { return a > b ? a : b; }
INLINE Floats Min(Floats a, Floats b) { return a < b ? a : b; }
INLINE Ints Max(Ints a, Ints b) { return a > b ? a : b; }
INLINE Ints Min(Ints a, Ints b) { return a < b ? a : b; }
INLINE Floats Clamp01(Floats x) { return Min(Max(x, Floats{}), All(1)); }
INLINE Ints Bits(Floats x) { return reinterpret_cast<Ints>(x); }
INLINE Floats FromBits(Ints x) { return reinterpret_cast<Floats>(x); }
INLINE Floats Abs(Floats x) { return FromBits(Bits(x) & 0x7fffffff); }
INLINE Floats Real(Ints x) { return __builtin_convertvector(x, Floats); }
INLINE Ints Truncate(Floats x) { return __builtin_convertvector(x, Ints); }
INLINE Ints Floor(Floats x) {
  const Ints i = Truncate(x);
  return i + (Real(i) > x);  // a true comparison is -1
}

#if RECOLLECT_LANES == 16
INLINE bool Any(Ints mask) {
  const auto m = reinterpret_cast<__m512i>(mask);
  return _mm512_test_epi32_mask(m, m) != 0;
}
INLINE Floats Sqrt(Floats x) {
  return reinterpret_cast<Floats>(_mm512_maskz_sqrt_ps(0xffff, reinterpret_cast<__m512>(x)));
}
INLINE Ints Gather(const std::int32_t* table, Ints index) {
  return reinterpret_cast<Ints>(_mm512_mask_i32gather_epi32(
      _mm512_setzero_si512(), 0xffff, reinterpret_cast<__m512i>(index), table, 4));
}
#elif RECOLLECT_LANES == 8
INLINE bool Any(Ints mask) {
  const auto m = reinterpret_cast<__m256i>(mask);
  return _mm256_testz_si256(m, m) == 0;
}
INLINE Floats Sqrt(Floats x) {
  return reinterpret_cast<Floats>(_mm256_sqrt_ps(reinterpret_cast<__m256>(x)));
}
INLINE Ints Gather(const std::int32_t* table, Ints index) {
  return reinterpret_cast<Ints>(_mm256_i32gather_epi32(table, reinterpret_cast<__m256i>(index), 4));
}
#else
INLINE bool Any(Ints mask) {
  std::int32_t any = 0;
  for (int i = 0; i < kLanes; ++i) any |= mask[i];
  return any != 0;
}
INLINE Floats Sqrt(Floats x) {
  Floats r;
  for (int i = 0; i < kLanes; ++i) r[i] = __builtin_sqrtf(x[i]);
  return r;
}
INLINE Ints Gather(const std::int32_t* table, Ints index) {
  Ints r;
  for (int i = 0; i < kLanes; ++i) r[i] = table[index[i]];
  return r;
}
#endif

INLINE Floats Gather(const float* table, Ints index) {
  return FromBits(Gather(reinterpret_cast<const std::int32_t*>(table), index));
}

struct Vec {
  Floats x, y, z;
};
INLINE Vec operator+(const Vec& a, const Vec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
INLINE Vec operator-(const Vec& a, const Vec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
INLINE Vec operator*(const Vec& a, Floats s) { return {a.x * s, a.y * s, a.z * s}; }
INLINE Vec operator*(const Vec& a, const Vec& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
INLINE Floats Dot(const Vec& a, const Vec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
INLINE Vec Cross(const Vec& a, const Vec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
INLINE Vec All(const float* v) { return {All(v[0]), All(v[1]), All(v[2])}; }
INLINE Vec Mix(const Vec& a, const Vec& b, Floats t) { return a * (1 - t) + b * t; }
INLINE Vec Choose(Ints mask, const Vec& a, const Vec& b) {
  return {mask ? a.x : b.x, mask ? a.y : b.y, mask ? a.z : b.z};
}
INLINE Vec Load(const Lane3& v, int k) {
  return {Load(v.x.at + k), Load(v.y.at + k), Load(v.z.at + k)};
}
INLINE void Store(Lane3& v, int k, const Vec& a) {
  Store(v.x.at + k, a.x);
  Store(v.y.at + k, a.y);
  Store(v.z.at + k, a.z);
}

INLINE Floats SmoothStep(Floats low, Floats high, Floats x) {
  const Floats t = Clamp01((x - low) / (high - low));
  return t * t * (3 - 2 * t);
}

// Log2 of a positive number, within 0.01: enough to choose a mip level.
INLINE Floats FastLog2(Floats x) {
  const Ints bits = Bits(x);
  const Floats mantissa = FromBits((bits & 0x7fffff) | 0x3f800000);
  return Real((bits >> 23) - 127) + (-0.344845F * mantissa + 2.024658F) * mantissa - 1.674873F;
}

// e^x for x in [-80, 0], within 1e-5.
INLINE Floats FastExp(Floats x) {
  const Floats scaled = Max(x, All(-80)) * 1.44269504F;
  const Ints whole = Floor(scaled);
  const Floats f = scaled - Real(whole);
  const Floats power =
      1 + f * (0.693147F + f * (0.240227F + f * (0.0555041F + f * (0.0096181F + f * 0.0013334F))));
  return power * FromBits((whole + 127) << 23);
}

// Sine within 0.0011 (a parabola, bent once).
INLINE Floats FastSin(Floats x) {
  const Floats turns = x * 0.159154943F;
  const Floats t = turns - Real(Floor(turns + 0.5F));  // -0.5 to 0.5
  const Floats y = 8 * t - 16 * t * Abs(t);
  return 0.775F * y + 0.225F * y * Abs(y);
}

}  // namespace
}  // namespace recollect::simulation
