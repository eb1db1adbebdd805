#include <algorithm>
#include <cmath>

#include "recollect/simulation/noise.h"
#include "recollect/simulation/pictures.h"

namespace recollect::simulation {
namespace {

Color Gray(float x) { return {x, x, x}; }

// Fine grain of a picture of `size` texels: white noise texel by texel.
float Grain(float u, float v, int size, std::uint32_t seed) {
  const auto s = static_cast<float>(size);
  const auto h = LatticeHash(static_cast<int>(u * s), static_cast<int>(v * s), seed);
  return static_cast<float>(h >> 8) * 0x1.0p-24F;
}

Texel Asphalt(float u, float v) {
  const float stones = Fbm(u * 128, v * 128, 128, 2, 1);
  const float patches = Fbm(u * 5, v * 5, 5, 5, 2);
  float shade =
      0.085F * (0.55F + 0.6F * patches + 0.55F * stones) * (0.7F + 0.6F * Grain(u, v, 512, 3));
  const CellNoise cells = Cells(u * 4 + 0.35F * Fbm(u * 16, v * 16, 16, 3, 4),
                                v * 4 + 0.35F * Fbm(u * 16, v * 16, 16, 3, 5), 4, 6);
  const float crack = cells.second - cells.nearest;
  if (crack < 0.022F && Fbm(u * 6, v * 6, 6, 2, 7) > 0.5F) shade *= 0.35F;
  return {Color(1.02F, 1.0F, 0.96F) * shade, 1};
}

Texel Slabs(float u, float v) {
  const float x = u * 6, y = v * 6;
  const float edge =
      std::min({x - std::floor(x), std::ceil(x) - x, y - std::floor(y), std::ceil(y) - y});
  const auto id = LatticeHash(static_cast<int>(x), static_cast<int>(y), 11);
  const float tone = 0.8F + 0.35F * static_cast<float>(id & 255) / 255.0F;
  const float dirt = Fbm(u * 9, v * 9, 9, 6, 12, 0.65F);
  float shade = 0.30F * tone * (0.55F + 0.8F * dirt) * (0.85F + 0.3F * Grain(u, v, 512, 13));
  if (edge < 0.025F) shade *= 0.4F;
  return {Color(1.04F, 1.0F, 0.93F) * shade, 1};
}

Texel Pavers(float u, float v) {
  const float y = v * 16;
  const float row = std::floor(y);
  const float x = u * 8 + (static_cast<int>(row) % 2 == 0 ? 0.0F : 0.5F);
  const float ex = std::min(x - std::floor(x), std::ceil(x) - x) * 2;
  const float ey = std::min(y - row, row + 1 - y);
  const auto id = LatticeHash(static_cast<int>(std::floor(x)) % 8, static_cast<int>(row), 21);
  const float tone = 0.65F + 0.7F * static_cast<float>(id & 255) / 255.0F;
  const float dirt = Fbm(u * 8, v * 8, 8, 6, 22, 0.6F);
  float shade = 0.24F * tone * (0.6F + 0.7F * dirt) * (0.85F + 0.3F * Grain(u, v, 512, 23));
  if (std::min(ex, ey) < 0.08F) shade *= 0.35F;
  return {(id >> 9) % 5 == 0 ? Color(Color(1.25F, 0.8F, 0.62F) * shade) : Color(Gray(shade)), 1};
}

Texel Grass(float u, float v) {
  const float blades = Fbm(u * 96, v * 48, 48, 3, 31, 0.7F);
  const float tufts = Fbm(u * 14, v * 14, 14, 4, 32);
  const float dry = SmoothStep(0.5F, 0.75F, Fbm(u * 4, v * 4, 4, 5, 33));
  const float light =
      (0.35F + 0.9F * blades) * (0.5F + 0.9F * tufts) * (0.75F + 0.5F * Grain(u, v, 512, 34));
  const Color green(0.065F, 0.115F, 0.025F), straw(0.19F, 0.165F, 0.075F);
  return {(green * (1 - 0.6F * dry) + straw * 0.6F * dry) * light * 1.25F, 1};
}

Texel Earth(float u, float v) {
  const float a = Fbm(u * 6, v * 6, 6, 7, 41, 0.62F);
  const CellNoise stone = Cells(u * 40, v * 40, 40, 42);
  float light = (0.45F + 1.0F * a) * (0.8F + 0.4F * Grain(u, v, 512, 43));
  Color c = Color(0.26F, 0.135F, 0.07F) * light;
  if (stone.nearest < 0.25F && stone.id % 3 == 0) c = Gray(0.22F) * light;
  return {c, 1};
}

Texel Gravel(float u, float v) {
  const CellNoise stone = Cells(u * 48, v * 48, 48, 51);
  const float tone = 0.4F + 0.9F * static_cast<float>(stone.id & 255) / 255.0F;
  const float shade = 0.28F * tone * SmoothStep(0.0F, 0.25F, stone.second - stone.nearest);
  return {Color(1.0F, 0.96F, 0.88F) * (0.03F + shade), 1};
}

Texel RoadPaint(float u, float v) {
  const float worn = Fbm(u * 10, v * 10, 10, 7, 61, 0.7F);
  const float shade = 0.16F + 0.5F * SmoothStep(0.36F, 0.5F, worn);
  return {Gray(shade * (0.85F + 0.3F * Grain(u, v, 256, 62))), 1};
}

}  // namespace

Texture PaintGround(Picture picture) {
  switch (picture) {
    case Picture::kAsphalt:
      return Texture::Paint(512, Asphalt);
    case Picture::kSlabs:
      return Texture::Paint(512, Slabs);
    case Picture::kPavers:
      return Texture::Paint(512, Pavers);
    case Picture::kGrass:
      return Texture::Paint(512, Grass);
    case Picture::kEarth:
      return Texture::Paint(512, Earth);
    case Picture::kGravel:
      return Texture::Paint(512, Gravel);
    default:
      return Texture::Paint(256, RoadPaint);
  }
}

}  // namespace recollect::simulation
