#pragma once

#include "recollect/simulation/day.h"
#include "recollect/simulation/stock.h"

namespace recollect::simulation {

// The kinds of plants that stand about, as models about life size (scale instances by 0.7 to 1.4).
struct Plants {
  Plants(std::uint64_t seed, const Stock& stock, World& world);

  std::vector<int> broad, fine, tall, palms, flowering, bushes, tufts;

  // A colour of leaves for the plant `id` on a day: its own, drier or lusher by season.
  static Color Tint(std::uint64_t id, const Day& day);
};

}  // namespace recollect::simulation
