#include "recollect/simulation/noise.h"

#include <algorithm>
#include <cmath>

namespace recollect::simulation {
namespace {

int Wrap(int i, int period) {
  if (i >= 0 && i < period) return i;
  const int r = i % period;
  return r < 0 ? r + period : r;
}

float Unit(std::uint32_t hash) { return static_cast<float>(hash >> 8) * 0x1.0p-24F; }

}  // namespace

std::uint32_t LatticeHash(int x, int y, std::uint32_t seed) {
  std::uint32_t h = seed * 0x9e3779b9U + static_cast<std::uint32_t>(x) * 0x85ebca6bU +
                    static_cast<std::uint32_t>(y) * 0xc2b2ae35U;
  h = (h ^ (h >> 15)) * 0x2c1b3c6dU;
  h = (h ^ (h >> 12)) * 0x297a2d39U;
  return h ^ (h >> 15);
}

float ValueNoise(float x, float y, int period, std::uint32_t seed) {
  const float fx = std::floor(x), fy = std::floor(y);
  const int x0 = Wrap(static_cast<int>(fx), period), y0 = Wrap(static_cast<int>(fy), period);
  const int x1 = x0 + 1 == period ? 0 : x0 + 1, y1 = y0 + 1 == period ? 0 : y0 + 1;
  float u = x - fx, v = y - fy;
  u = u * u * (3 - 2 * u);
  v = v * v * (3 - 2 * v);
  const float a = Unit(LatticeHash(x0, y0, seed)), b = Unit(LatticeHash(x1, y0, seed));
  const float c = Unit(LatticeHash(x0, y1, seed)), d = Unit(LatticeHash(x1, y1, seed));
  return (a + (b - a) * u) * (1 - v) + (c + (d - c) * u) * v;
}

float Fbm(float x, float y, int period, int octaves, std::uint32_t seed, float gain) {
  float sum = 0, weight = 1, total = 0;
  for (int i = 0; i < octaves; ++i) {
    sum += weight * ValueNoise(x, y, period, seed + static_cast<std::uint32_t>(i));
    total += weight;
    weight *= gain;
    x *= 2;
    y *= 2;
    period *= 2;
  }
  return sum / total;
}

CellNoise Cells(float x, float y, int period, std::uint32_t seed) {
  const int cx = static_cast<int>(std::floor(x)), cy = static_cast<int>(std::floor(y));
  CellNoise result{9, 9, 0};
  for (int j = cy - 1; j <= cy + 1; ++j) {
    for (int i = cx - 1; i <= cx + 1; ++i) {
      const std::uint32_t h = LatticeHash(Wrap(i, period), Wrap(j, period), seed);
      const float px = static_cast<float>(i) + static_cast<float>(h & 0xffff) / 65536.0F;
      const float py = static_cast<float>(j) + static_cast<float>(h >> 16) / 65536.0F;
      const float d = std::sqrt((px - x) * (px - x) + (py - y) * (py - y));
      if (d < result.nearest) {
        result = {d, result.nearest, h};
      } else {
        result.second = std::min(result.second, d);
      }
    }
  }
  return result;
}

float SmoothStep(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0F, 1.0F);
  return t * t * (3 - 2 * t);
}

}  // namespace recollect::simulation
