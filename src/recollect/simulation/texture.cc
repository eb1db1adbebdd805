#include "recollect/simulation/texture.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "recollect/core/error.h"

namespace recollect::simulation {
namespace {

// Numbers handled together; GCC and Clang turn these into vector instructions anywhere.
using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));
using Short8 = std::uint16_t __attribute__((vector_size(16)));
using Byte16 = std::uint8_t __attribute__((vector_size(16)));
using Long2 = std::uint64_t __attribute__((vector_size(16)));

// Two neighbouring texels, each channel in 16 bits.
Short8 LoadPair(const std::uint8_t* texel) {
  std::uint64_t bytes = 0;
  std::memcpy(&bytes, texel, sizeof bytes);
  const Byte16 low = reinterpret_cast<Byte16>(Long2{bytes, 0});
  return reinterpret_cast<Short8>(__builtin_shuffle(
      low, Byte16{}, Byte16{0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23}));
}

int Floor(float x) {
  const int i = static_cast<int>(x);
  return i - static_cast<int>(static_cast<float>(i) > x);
}

// 256 times the bytes interpolated at (u, v). Rows end with their first texel again, the level
// with its first row.
Float4 Bilinear(const std::uint8_t* level, int size, float u, float v) {
  const float scale = static_cast<float>(size);
  const float x = u * scale - 0.5F, y = v * scale - 0.5F;
  const int fx = Floor(x), fy = Floor(y);
  const int mask = size - 1, row = size + 1;
  const std::uint8_t* at = level + 4 * ((fy & mask) * row + (fx & mask));
  const auto below = static_cast<std::uint16_t>((y - static_cast<float>(fy)) * 256);
  const auto above = static_cast<std::uint16_t>(256 - below);
  const Short8 column = LoadPair(at) * above + LoadPair(at + 4 * row) * below;
  const Short8 left = __builtin_shuffle(column, Short8{}, Short8{0, 8, 1, 8, 2, 8, 3, 8});
  const Short8 right = __builtin_shuffle(column, Short8{}, Short8{4, 8, 5, 8, 6, 8, 7, 8});
  const Float4 a = __builtin_convertvector(reinterpret_cast<Int4>(left), Float4);
  const Float4 b = __builtin_convertvector(reinterpret_cast<Int4>(right), Float4);
  return a + (b - a) * (x - static_cast<float>(fx));
}

Float4 Squared(Float4 c) { return c * c * (1.0F / (255.0F * 255.0F * 256.0F * 256.0F)); }

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
    offsets_.push_back(rgba_.size());
    solid_offsets_.push_back(solid_.size());
    const float scale = coverage < 1 && s < size ? CoverageScale(level, coverage) : 1.0F;
    for (const Texel& t : level) solid_.push_back(Byte(t.alpha * scale));
    for (int i = 0; i < (s + 1) * (s + 1); ++i) {
      const int x = i % (s + 1) % s, y = i / (s + 1) % s;
      const Texel& t = level[static_cast<std::size_t>(y * s + x)];
      for (int c = 0; c < 3; ++c) rgba_.push_back(Byte(std::sqrt(std::max(0.0F, t.color[c]))));
      rgba_.push_back(Byte(t.alpha));
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

Color Texture::Sample(float u, float v, float minor, float du, float dv) const {
  const float major = std::sqrt(du * du + dv * dv);
  const float width = std::max(minor, major * 0.25F);
  const float lod = FastLog2(std::max(width * static_cast<float>(size_), 1.0F));
  const int level = std::min(static_cast<int>(lod), levels_ - 1);
  // Two levels are mixed about half-way between them only: either alone does elsewhere.
  const float mix = (lod - static_cast<float>(level)) * 2 - 0.5F;
  const int near = mix >= 1 ? std::min(level + 1, levels_ - 1) : level;
  const bool both = mix > 0 && mix < 1 && level + 1 < levels_;
  const std::uint8_t* texels = &rgba_[offsets_[static_cast<std::size_t>(near)]];
  const std::uint8_t* next = both ? &rgba_[offsets_[static_cast<std::size_t>(near) + 1]] : nullptr;
  const int taps = std::clamp(static_cast<int>(0.75F * major / width + 0.5F), 1, 3);
  const float step = 1 / static_cast<float>(taps);
  Float4 sum{};
  for (int i = 0; i < taps; ++i) {
    const float s = (static_cast<float>(i) + 0.5F) * step - 0.5F;
    Float4 c = Bilinear(texels, size_ >> near, u + s * du, v + s * dv);
    if (both) c += (Bilinear(next, size_ >> (near + 1), u + s * du, v + s * dv) - c) * mix;
    sum += Squared(c);
  }
  sum *= step;
  return {sum[0], sum[1], sum[2]};
}

Color Texture::Smooth(float u, float v, float width) const {
  const float lod = FastLog2(std::max(width * static_cast<float>(size_), 1.0F)) + 0.5F;
  const int level = std::min(static_cast<int>(lod), levels_ - 1);
  const Float4 c =
      Squared(Bilinear(&rgba_[offsets_[static_cast<std::size_t>(level)]], size_ >> level, u, v));
  return {c[0], c[1], c[2]};
}

bool Texture::Solid(float u, float v, int level) const {
  level = std::clamp(level, 0, levels_ - 1);
  const int size = size_ >> level;
  const float scale = static_cast<float>(size);
  const int x = Floor(u * scale) & (size - 1), y = Floor(v * scale) & (size - 1);
  return solid_[solid_offsets_[static_cast<std::size_t>(level)] +
                static_cast<std::size_t>(y * size + x)] > 127;
}

}  // namespace recollect::simulation
