#include "recollect/cnn/softmax_rows.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "recollect/cnn/processors.h"

namespace recollect::cnn {
namespace {

// Sums and maxima are kept in so many lanes, which makes them vectors without the compiler having
// to reorder them.
constexpr std::int64_t kLanes = 16;

// exp within 2 units in the last place for x <= 0: 2^n (1 + r + ...), n = round(x / ln 2).
inline float Exp(float x) {
  constexpr float kLog2E = 1.44269504F, kLn2High = 0.693145752F, kLn2Low = 1.42860677e-6F;
  constexpr float kRound = 12582912.F;  // 1.5 * 2^23: adding it leaves the nearest integer
  x = x < -87.F ? -87.F : x;
  const float shifted = x * kLog2E + kRound;
  const float n = shifted - kRound;
  const float r = (x - n * kLn2High) - n * kLn2Low;
  float p = 1.38888889e-3F;
  p = p * r + 8.33333333e-3F;
  p = p * r + 4.16666667e-2F;
  p = p * r + 1.66666667e-1F;
  p = p * r + 0.5F;
  p = p * r + 1.F;
  p = p * r + 1.F;
  const auto power = static_cast<std::uint32_t>(std::bit_cast<std::uint32_t>(shifted) << 23);
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(p) + power);
}

}  // namespace

RECOLLECT_FOR_EACH_PROCESSOR
float Greatest(const float* scores, std::int64_t count, std::int64_t* best) {
  std::array<float, kLanes> most;
  most.fill(scores[0]);
  const std::int64_t whole = count - count % kLanes;
  for (std::int64_t i = 0; i < whole; i += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const float score = scores[i + static_cast<std::int64_t>(lane)];
      most[lane] = most[lane] < score ? score : most[lane];
    }
  }
  float greatest = *std::max_element(most.begin(), most.end());
  for (std::int64_t i = whole; i < count; ++i) greatest = std::max(greatest, scores[i]);
  *best = std::find(scores, scores + count, greatest) - scores;
  return greatest;
}

double Greatest(const double* scores, std::int64_t count, std::int64_t* best) {
  *best = std::max_element(scores, scores + count) - scores;
  return scores[*best];
}

RECOLLECT_FOR_EACH_PROCESSOR
float LogSumExp(const float* scores, std::int64_t count, float greatest) {
  std::array<float, kLanes> sums{};
  const std::int64_t whole = count - count % kLanes;
  for (std::int64_t i = 0; i < whole; i += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      sums[lane] += Exp(scores[i + static_cast<std::int64_t>(lane)] - greatest);
    }
  }
  float sum = 0;
  for (const float lane : sums) sum += lane;
  for (std::int64_t i = whole; i < count; ++i) sum += Exp(scores[i] - greatest);
  return greatest + std::log(sum);
}

double LogSumExp(const double* scores, std::int64_t count, double greatest) {
  double sum = 0;
  for (std::int64_t i = 0; i < count; ++i) sum += std::exp(scores[i] - greatest);
  return greatest + std::log(sum);
}

RECOLLECT_FOR_EACH_PROCESSOR
void ScaledSoftmax(float* scores, std::int64_t count, float total, float scale) {
  for (std::int64_t i = 0; i < count; ++i) scores[i] = scale * Exp(scores[i] - total);
}

void ScaledSoftmax(double* scores, std::int64_t count, double total, double scale) {
  for (std::int64_t i = 0; i < count; ++i) scores[i] = scale * std::exp(scores[i] - total);
}

}  // namespace recollect::cnn
