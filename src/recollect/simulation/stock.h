#pragma once

#include "recollect/core/random.h"
#include "recollect/simulation/world.h"

namespace recollect::simulation {

// The materials that many things are made of, by number in a palette.
struct Stock {
  explicit Stock(Palette& palette);

  int kerb, white_paint, yellow_paint, old_concrete, dark, manhole;
  int grass, earth, gravel, slabs, pavers, forest, hedge;
  int bark, steel, rust, wood, white, black, rubber;
  int glass, window_frame, windows, signs, posters, traffic_signs;
  int paint, chrome, car_glass, head_lamp, tail_lamp;
  int broad_leaves, fine_leaves, long_leaves, palm_frond, blossom, grass_tuft, wire_mesh;
};

// A number from `random` as a float in [low, high).
inline float Draw(Random& random, double low, double high) {
  return static_cast<float>(random.Uniform(low, high));
}

// A wall or car colour as people choose them: mostly pale or gray, now and then strong.
Color DrawPaint(Random& random);

}  // namespace recollect::simulation
