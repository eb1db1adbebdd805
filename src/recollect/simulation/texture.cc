#include "recollect/simulation/texture.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "recollect/core/error.h"

namespace recollect::simulation {
namespace {

int Floor(float x) {
  const int i = static_cast<int>(x);
  return i - static_cast<int>(static_cast<float>(i) > x);
}

std::uint32_t Byte(float x) {
  return static_cast<std::uint32_t>(std::clamp(x, 0.0F, 1.0F) * 255.0F + 0.5F);
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
    starts_.push_back(texels_.size());
    solid_starts_.push_back(solid_.size());
    const float scale = coverage < 1 && s < size ? CoverageScale(level, coverage) : 1.0F;
    for (const Texel& t : level) solid_.push_back(static_cast<std::uint8_t>(Byte(t.alpha * scale)));
    for (int i = 0; i < (s + 1) * (s + 1); ++i) {
      const int x = i % (s + 1) % s, y = i / (s + 1) % s;
      const Texel& t = level[static_cast<std::size_t>(y * s + x)];
      std::uint32_t texel = Byte(t.alpha) << 24;
      for (int c = 0; c < 3; ++c) texel |= Byte(std::sqrt(std::max(0.0F, t.color[c]))) << (8 * c);
      texels_.push_back(texel);
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
  levels_ = static_cast<int>(starts_.size());
}

bool Texture::Solid(float u, float v, int level) const {
  level = std::clamp(level, 0, levels_ - 1);
  const int size = size_ >> level;
  const float scale = static_cast<float>(size);
  const int x = Floor(u * scale) & (size - 1), y = Floor(v * scale) & (size - 1);
  return solid_[solid_starts_[static_cast<std::size_t>(level)] +
                static_cast<std::size_t>(y * size + x)] > 127;
}

}  // namespace recollect::simulation
