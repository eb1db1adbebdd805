#include "recollect/cnn/elementwise.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "recollect/cnn/processors.h"

namespace recollect::cnn {
namespace {

constexpr std::int64_t kLanes = 16;    // sums in so many lanes become vectors
constexpr std::int64_t kBlock = 4096;  // values summed in float before double takes over

// What is inlined is compiled for each processor with the function that it goes into.
#define RECOLLECT_INLINE [[gnu::always_inline]] inline

RECOLLECT_INLINE float Read(float value) { return value; }
RECOLLECT_INLINE float Read(std::uint16_t bits) {
  return std::bit_cast<float>(std::uint32_t{bits} << 16);
}
RECOLLECT_INLINE void Write(float value, float& to) { to = value; }
// Rounded to the nearest, of two equally near the even one.
RECOLLECT_INLINE void Write(float value, std::uint16_t& to) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  to = static_cast<std::uint16_t>((bits + 0x7fff + (bits >> 16 & 1)) >> 16);
}

template <typename Value>
RECOLLECT_INLINE void RectifyAll(Value* values, std::int64_t count, float slope) {
  for (std::int64_t i = 0; i < count; ++i) {
    const float value = Read(values[i]);
    Write(value < 0 ? value * slope : value, values[i]);
  }
}

template <typename Value>
RECOLLECT_INLINE double RectifyAllBackward(const Value* rectified, const Value* gradient,
                                           Value* out, std::int64_t count, float slope) {
  double sum = 0;
  for (std::int64_t from = 0; from < count; from += kBlock) {
    const std::int64_t to = std::min(count, from + kBlock);
    std::array<float, kLanes> lanes{};
    std::int64_t i = from;
    for (; i + kLanes <= to; i += kLanes) {
      for (std::int64_t lane = 0; lane < kLanes; ++lane) {
        const float y = Read(rectified[i + lane]), g = Read(gradient[i + lane]);
        Write(y < 0 ? g * slope : g, out[i + lane]);
        lanes[static_cast<std::size_t>(lane)] += y < 0 ? g * y : 0.F;
      }
    }
    for (; i < to; ++i) {
      const float y = Read(rectified[i]), g = Read(gradient[i]);
      Write(y < 0 ? g * slope : g, out[i]);
      sum += y < 0 ? g * y : 0.F;
    }
    for (const float lane : lanes) sum += lane;
  }
  return sum;
}

}  // namespace

RECOLLECT_FOR_EACH_PROCESSOR
void AdamStep(float* parameter, float* mean, float* square, const float* gradient,
              std::int64_t count, const AdamRates& rates) {
  const AdamRates r = rates;
  for (std::int64_t i = 0; i < count; ++i) {
    const float g = gradient[i] * r.gradient_scale;
    const float m = r.beta1 * mean[i] + (1 - r.beta1) * g;
    const float s = r.beta2 * square[i] + (1 - r.beta2) * g * g;
    mean[i] = m;
    square[i] = s;
    parameter[i] = parameter[i] * r.keep - r.step * m / (std::sqrt(s) * r.root_scale + r.epsilon);
  }
}

RECOLLECT_FOR_EACH_PROCESSOR
double SquareSum(const float* values, std::int64_t count) {
  double sum = 0;
  for (std::int64_t from = 0; from < count; from += kBlock) {
    const std::int64_t to = std::min(count, from + kBlock);
    std::array<float, kLanes> lanes{};
    std::int64_t i = from;
    for (; i + kLanes <= to; i += kLanes) {
      for (std::int64_t lane = 0; lane < kLanes; ++lane) {
        lanes[static_cast<std::size_t>(lane)] += values[i + lane] * values[i + lane];
      }
    }
    for (; i < to; ++i) sum += values[i] * values[i];
    for (const float lane : lanes) sum += lane;
  }
  return sum;
}

RECOLLECT_FOR_EACH_PROCESSOR
void Rectify(float* values, std::int64_t count, float slope) { RectifyAll(values, count, slope); }

RECOLLECT_FOR_EACH_PROCESSOR
void RectifyBfloat16(std::uint16_t* values, std::int64_t count, float slope) {
  RectifyAll(values, count, slope);
}

RECOLLECT_FOR_EACH_PROCESSOR
double RectifyBackward(const float* rectified, const float* gradient, float* out,
                       std::int64_t count, float slope) {
  return RectifyAllBackward(rectified, gradient, out, count, slope);
}

RECOLLECT_FOR_EACH_PROCESSOR
double RectifyBackwardBfloat16(const std::uint16_t* rectified, const std::uint16_t* gradient,
                               std::uint16_t* out, std::int64_t count, float slope) {
  return RectifyAllBackward(rectified, gradient, out, count, slope);
}

}  // namespace recollect::cnn
