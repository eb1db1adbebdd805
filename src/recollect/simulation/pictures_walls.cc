#include <algorithm>
#include <cmath>

#include "recollect/simulation/noise.h"
#include "recollect/simulation/pictures.h"

namespace recollect::simulation {
namespace {

float Part(std::uint32_t hash) { return static_cast<float>(hash & 0xffff) / 65535.0F; }
float Fraction(float x) { return x - std::floor(x); }
// Distance of x to the nearest whole number.
float Joint(float x) { return std::abs(x - std::round(x)); }

float Grain(float u, float v, std::uint32_t seed) {
  return Part(LatticeHash(static_cast<int>(u * 512), static_cast<int>(v * 512), seed));
}

// Rain marks: long streaks down a wall, about 1, darker where the water ran.
float Streaks(float u, float v, std::uint32_t seed) {
  const float fine = Fbm(u * 64, v * 3, 3, 4, seed, 0.6F),
              broad = Fbm(u * 12, v * 2, 2, 4, seed + 9);
  return 1.0F - 0.55F * SmoothStep(0.5F, 0.8F, 0.5F * fine + 0.5F * broad);
}

Texel Concrete(float u, float v) {
  const float cloud = Fbm(u * 5, v * 5, 5, 7, 101, 0.6F);
  const CellNoise pores = Cells(u * 40, v * 40, 40, 102);
  float shade =
      0.36F * (0.6F + 0.75F * cloud) * Streaks(u, v, 103) * (0.88F + 0.24F * Grain(u, v, 104));
  if (pores.nearest < 0.13F && pores.id % 4 == 0) shade *= 0.5F;
  return {Color(1.0F, 0.98F, 0.92F) * shade, 1};
}

Texel BoardConcrete(float u, float v) {
  const float y = v * 20;
  const auto board = LatticeHash(static_cast<int>(y), static_cast<int>(u * 3), 111);
  const float wood = Fbm(u * 12, v * 160, 12, 3, 112);
  float shade = 0.33F * (0.8F + 0.3F * Part(board)) * (0.7F + 0.55F * wood) * Streaks(u, v, 113);
  if (Joint(y) < 0.06F) shade *= 0.6F;
  return {Color(1.0F, 0.97F, 0.9F) * shade * (0.9F + 0.2F * Grain(u, v, 114)), 1};
}

Texel Brick(float u, float v) {
  const float y = v * 24;
  const float row = std::floor(y);
  const float x = u * 8 + (static_cast<int>(row) % 2 == 0 ? 0.0F : 0.5F);
  const auto id = LatticeHash(static_cast<int>(std::floor(x)) % 8, static_cast<int>(row), 121);
  const float grain =
      (0.7F + 0.5F * Fbm(u * 48, v * 48, 48, 3, 122)) * (0.85F + 0.3F * Grain(u, v, 123));
  if (Joint(x) < 0.04F || Joint(y) < 0.1F) return {Color(0.33F, 0.3F, 0.26F) * grain, 1};
  const float tone = 0.55F + 0.8F * Part(id);
  return {Color(0.33F, 0.125F + 0.04F * Part(id >> 8), 0.075F) * tone * grain * Streaks(u, v, 124),
          1};
}

Texel Plaster(float u, float v) {
  const float cloud = Fbm(u * 4, v * 4, 4, 7, 131, 0.62F);
  const float bumps = Fbm(u * 90, v * 90, 90, 2, 132);
  const float foot = 1.0F - 0.25F * SmoothStep(0.4F, 0.7F, Fbm(u * 9, v * 5, 1, 5, 133));
  const float shade = (0.72F + 0.36F * cloud) * (0.86F + 0.28F * bumps) * Streaks(u, v, 134) * foot;
  return {Color(0.72F, 0.71F, 0.68F) * shade * (0.93F + 0.14F * Grain(u, v, 135)), 1};
}

Texel Tiles(float u, float v) {
  const float x = u * 16, y = v * 16;
  const auto id = LatticeHash(static_cast<int>(x), static_cast<int>(y), 141);
  const float glaze = 0.9F + 0.2F * Fbm(u * 30, v * 30, 30, 3, 142);
  if (std::min(Joint(x), Joint(y)) < 0.05F) return {Color(0.4F, 0.38F, 0.35F), 1};
  // A quarter circle in every other tile: the pattern of many a Brazilian wall.
  const bool motif = id % 2 == 0 && std::hypot(Fraction(x), Fraction(y)) < 0.7F;
  return {(motif ? Color(0.22F, 0.33F, 0.5F) : Color(0.68F, 0.69F, 0.7F)) * glaze *
              (0.75F + 0.35F * Part(id >> 7)),
          1};
}

Texel Stone(float u, float v) {
  const CellNoise c = Cells(u * 9 + 0.3F * Fbm(u * 18, v * 18, 18, 3, 151), v * 9, 9, 152);
  const float gap = c.second - c.nearest;
  const float face =
      (0.6F + 0.75F * Fbm(u * 30, v * 30, 30, 5, 153, 0.65F)) * (0.85F + 0.3F * Grain(u, v, 155));
  if (gap < 0.07F) return {Color(0.15F, 0.14F, 0.12F) * face, 1};
  const float tone = 0.5F + 0.9F * Part(c.id);
  const Color warm(0.30F, 0.25F, 0.18F), cool(0.22F, 0.23F, 0.24F);
  return {(Part(c.id >> 9) > 0.5F ? warm : cool) * tone * face, 1};
}

Texel RoofTiles(float u, float v) {
  const float x = u * 16, y = v * 10;
  const auto id = LatticeHash(static_cast<int>(x), static_cast<int>(y), 161);
  const float round = 0.45F + 0.55F * std::sin(Fraction(x) * 3.14159F);
  const float lap = 0.55F + 0.45F * SmoothStep(0.0F, 0.25F, Fraction(y));
  const float age = 0.6F + 0.7F * Fbm(u * 6, v * 6, 6, 6, 162);
  return {Color(0.34F, 0.145F, 0.08F) * (0.7F + 0.5F * Part(id)) * round * lap * age, 1};
}

Texel Metal(float u, float v) {
  const float wave = 0.72F + 0.28F * std::cos(u * 20 * 6.28318F);
  const float rust = SmoothStep(0.62F, 0.8F, Fbm(u * 6, v * 6, 6, 6, 171, 0.6F));
  const Color zinc(0.42F, 0.43F, 0.44F), brown(0.25F, 0.12F, 0.06F);
  const float dirt = 0.8F + 0.35F * Fbm(u * 20, v * 4, 4, 4, 172);
  return {(zinc * (1 - rust) + brown * rust) * wave * dirt * (0.92F + 0.16F * Grain(u, v, 173)), 1};
}

Texel Wood(float u, float v) {
  const float x = u * 10;
  const auto plank = LatticeHash(static_cast<int>(x), 0, 181);
  const float fibre = Fbm(u * 120, v * 6 + 7 * Part(plank), 6, 4, 182, 0.6F);
  float shade = (0.55F + 0.5F * Part(plank >> 3)) * (0.5F + 0.9F * fibre);
  if (Joint(x) < 0.04F) shade *= 0.25F;
  return {Color(0.27F, 0.17F, 0.095F) * shade, 1};
}

Texel Cloth(float u, float v) {
  const float fold = 0.75F + 0.4F * Fbm(u * 6, v * 3, 3, 4, 191);
  const float weave = 0.85F + 0.3F * Grain(u, v, 192);
  const float band = Part(LatticeHash(0, static_cast<int>(v * 8), 193)) > 0.7F ? 0.6F : 1.0F;
  return {Color(0.85F, 0.85F, 0.85F) * fold * weave * band, 1};
}

}  // namespace

Texture PaintWall(Picture picture) {
  switch (picture) {
    case Picture::kConcrete:
      return Texture::Paint(512, Concrete);
    case Picture::kBoardConcrete:
      return Texture::Paint(512, BoardConcrete);
    case Picture::kBrick:
      return Texture::Paint(512, Brick);
    case Picture::kPlaster:
      return Texture::Paint(512, Plaster);
    case Picture::kTiles:
      return Texture::Paint(512, Tiles);
    case Picture::kStone:
      return Texture::Paint(512, Stone);
    case Picture::kRoofTiles:
      return Texture::Paint(512, RoofTiles);
    case Picture::kMetal:
      return Texture::Paint(512, Metal);
    case Picture::kWood:
      return Texture::Paint(512, Wood);
    default:
      return Texture::Paint(256, Cloth);
  }
}

}  // namespace recollect::simulation
