#pragma once

#include <cstdint>

namespace recollect::simulation {

// A 32-bit hash of a lattice point: the ground of all noises here.
std::uint32_t LatticeHash(int x, int y, std::uint32_t seed);

// Smooth value noise in [0, 1] over the unit lattice. It repeats every `period` cells (> 0) along
// both axes, so textures made of it tile without a seam.
float ValueNoise(float x, float y, int period, std::uint32_t seed);

// Sum of `octaves` value noises, each twice as fine and `gain` times as strong as the last,
// scaled to [0, 1].
float Fbm(float x, float y, int period, int octaves, std::uint32_t seed, float gain = 0.5F);

// Distances (in cells) to the nearest and second nearest of one random point a cell, and the
// nearest one's hash. Repeats every `period` cells.
struct CellNoise {
  float nearest, second;
  std::uint32_t id;
};
CellNoise Cells(float x, float y, int period, std::uint32_t seed);

// 0 below `low`, 1 above `high`, smooth in between.
float SmoothStep(float low, float high, float x);

}  // namespace recollect::simulation
