#include "recollect/simulation/texture.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "recollect/core/error.h"

namespace recollect::simulation {
namespace {

// Four numbers handled as one; GCC and Clang turn these into vector instructions anywhere.
using Float4 = float __attribute__((vector_size(16)));
using Byte4 = std::uint8_t __attribute__((vector_size(4)));

Float4 Load(const std::uint8_t* texel) {
  Byte4 bytes;
  std::memcpy(&bytes, texel, sizeof bytes);
  return __builtin_convertvector(bytes, Float4);
}

Float4 Bilinear(const std::uint8_t* level, int size, float u, float v) {
  const float scale = static_cast<float>(size);
  const float x = u * scale - 0.5F, y = v * scale - 0.5F;
  const float fx = std::floor(x), fy = std::floor(y);
  const int mask = size - 1;
  const int x0 = static_cast<int>(fx) & mask, x1 = (x0 + 1) & mask;
  const int y0 = (static_cast<int>(fy) & mask) * size,
            y1 = ((static_cast<int>(fy) + 1) & mask) * size;
  const float a = x - fx, b = y - fy;
  const Float4 top = Load(level + 4 * (y0 + x0)) * (1 - a) + Load(level + 4 * (y0 + x1)) * a;
  const Float4 bottom = Load(level + 4 * (y1 + x0)) * (1 - a) + Load(level + 4 * (y1 + x1)) * a;
  return top * (1 - b) + bottom * b;
}

std::uint8_t Byte(float x) {
  return static_cast<std::uint8_t>(std::clamp(x, 0.0F, 1.0F) * 255.0F + 0.5F);
}

// Scale of alpha with which a share `coverage` of the texels is above one half.
float CoverageScale(const std::vector<Texel>& texels, float coverage) {
  std::vector<float> alpha;
  alpha.reserve(texels.size());
  for (const Texel& t : texels) alpha.push_back(t.alpha);
  const auto rank =
      static_cast<std::ptrdiff_t>(std::clamp((1 - coverage) * static_cast<float>(alpha.size()),
                                             0.0F, static_cast<float>(alpha.size() - 1)));
  std::nth_element(alpha.begin(), alpha.begin() + rank, alpha.end());
  const float median = alpha[static_cast<std::size_t>(rank)];
  return median > 0.01F ? 0.51F / median : 1.0F;
}

// Log2 of a positive number, within 0.01: enough to choose a mip level.
float FastLog2(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  const auto mantissa = std::bit_cast<float>((bits & 0x7fffffU) | 0x3f800000U);
  const auto exponent = static_cast<float>(static_cast<int>(bits >> 23) - 127);
  return exponent + (-0.344845F * mantissa + 2.024658F) * mantissa - 1.674873F;
}

}  // namespace

Texture Texture::Paint(int size, const std::function<Texel(float u, float v)>& paint) {
  std::vector<Texel> texels;
  texels.reserve(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  const float step = 1.0F / static_cast<float>(size);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      texels.push_back(
          paint((static_cast<float>(x) + 0.5F) * step, (static_cast<float>(y) + 0.5F) * step));
    }
  }
  return {size, texels};
}

Texture::Texture(int size, const std::vector<Texel>& texels) : size_(size) {
  Require(size > 0 && std::has_single_bit(static_cast<unsigned>(size)), "texture",
          "its size must be a power of two");
  const auto solid =
      std::count_if(texels.begin(), texels.end(), [](const Texel& t) { return t.alpha > 0.5F; });
  const float coverage = static_cast<float>(solid) / static_cast<float>(texels.size());
  std::vector<Texel> level = texels;
  for (int s = size;; s /= 2) {
    offsets_.push_back(solid_.size());
    const float scale = coverage < 1 && s < size ? CoverageScale(level, coverage) : 1.0F;
    for (const Texel& t : level) {
      for (int c = 0; c < 3; ++c) rgba_.push_back(Byte(std::sqrt(std::max(0.0F, t.color[c]))));
      rgba_.push_back(Byte(t.alpha));
      solid_.push_back(Byte(t.alpha * scale));
    }
    if (s == 1) break;
    // Colours weigh by alpha, so that what lies behind a leaf's outline does not bleed into it.
    std::vector<Texel> half(level.size() / 4);
    for (int y = 0; y < s / 2; ++y) {
      for (int x = 0; x < s / 2; ++x) {
        Texel sum{Color::Zero(), 0};
        for (int k = 0; k < 4; ++k) {
          const Texel& t = level[static_cast<std::size_t>((2 * y + k / 2) * s + 2 * x + k % 2)];
          sum.color += t.color * (t.alpha + 1e-3F);
          sum.alpha += t.alpha;
        }
        sum.color /= sum.alpha + 4e-3F;
        sum.alpha /= 4;
        half[static_cast<std::size_t>(y * (s / 2) + x)] = sum;
      }
    }
    level = std::move(half);
  }
  levels_ = static_cast<int>(offsets_.size());
}

Color Texture::Trilinear(float u, float v, float lod) const {
  const int level = std::min(static_cast<int>(lod), levels_ - 1);
  const int next = std::min(level + 1, levels_ - 1);
  const float t = std::min(lod - static_cast<float>(level), 1.0F);
  Float4 c = Bilinear(&rgba_[4 * offsets_[static_cast<std::size_t>(level)]], size_ >> level, u, v);
  if (t > 0.05F && next != level) {
    c = c * (1 - t) +
        t * Bilinear(&rgba_[4 * offsets_[static_cast<std::size_t>(next)]], size_ >> next, u, v);
  }
  c *= c * (1.0F / (255.0F * 255.0F));
  return {c[0], c[1], c[2]};
}

Color Texture::Sample(float u, float v, float minor, float du, float dv) const {
  const float major = std::sqrt(du * du + dv * dv);
  const float width = std::max(minor, major * 0.25F);
  const float lod = std::max(0.0F, FastLog2(std::max(width * static_cast<float>(size_), 1.0F)));
  const int taps = major > 1.5F * width ? std::min(4, static_cast<int>(major / width + 0.5F)) : 1;
  if (taps == 1) return Trilinear(u, v, lod);
  Color sum = Color::Zero();
  for (int i = 0; i < taps; ++i) {
    const float s = (static_cast<float>(i) + 0.5F) / static_cast<float>(taps) - 0.5F;
    sum += Trilinear(u + s * du, v + s * dv, lod);
  }
  return sum / static_cast<float>(taps);
}

bool Texture::Solid(float u, float v, int level) const {
  level = std::clamp(level, 0, levels_ - 1);
  const int size = size_ >> level;
  const float scale = static_cast<float>(size);
  const int x = static_cast<int>(u * scale + 4096.0F * scale) & (size - 1);
  const int y = static_cast<int>(v * scale + 4096.0F * scale) & (size - 1);
  return solid_[offsets_[static_cast<std::size_t>(level)] +
                static_cast<std::size_t>(y * size + x)] > 127;
}

}  // namespace recollect::simulation
