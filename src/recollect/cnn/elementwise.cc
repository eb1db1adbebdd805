#include "recollect/cnn/elementwise.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "recollect/cnn/processors.h"

namespace recollect::cnn {
namespace {

constexpr std::int64_t kLanes = 16;    // sums in so many lanes become vectors
constexpr std::int64_t kBlock = 4096;  // values summed in float before double takes over

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
void Rectify(float* values, std::int64_t count, float slope) {
  for (std::int64_t i = 0; i < count; ++i) {
    values[i] = values[i] < 0 ? values[i] * slope : values[i];
  }
}

RECOLLECT_FOR_EACH_PROCESSOR
double RectifyBackward(const float* rectified, const float* gradient, float* out,
                       std::int64_t count, float slope) {
  double sum = 0;
  for (std::int64_t from = 0; from < count; from += kBlock) {
    const std::int64_t to = std::min(count, from + kBlock);
    std::array<float, kLanes> lanes{};
    std::int64_t i = from;
    for (; i + kLanes <= to; i += kLanes) {
      for (std::int64_t lane = 0; lane < kLanes; ++lane) {
        const float y = rectified[i + lane], g = gradient[i + lane];
        out[i + lane] = y < 0 ? g * slope : g;
        lanes[static_cast<std::size_t>(lane)] += y < 0 ? g * y : 0.F;
      }
    }
    for (; i < to; ++i) {
      const float y = rectified[i], g = gradient[i];
      out[i] = y < 0 ? g * slope : g;
      sum += y < 0 ? g * y : 0.F;
    }
    for (const float lane : lanes) sum += lane;
  }
  return sum;
}

}  // namespace recollect::cnn
