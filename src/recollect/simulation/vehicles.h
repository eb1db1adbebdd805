#pragma once

#include <vector>

#include "recollect/simulation/stock.h"

namespace recollect::simulation {

// Cars, buses, lorries and people as models: x forward, origin on the ground at their middle.
// Bodies take the instance's tint.
struct Vehicles {
  Vehicles() = default;
  Vehicles(std::uint64_t seed, const Stock& stock, World& world);

  std::vector<int> cars;     // 3.5 to 5 m long
  std::vector<int> lorries;  // buses, vans and lorries, 5.5 to 11 m
  std::vector<int> people;
  std::vector<float> lengths;  // by model number, metres; 0 for other models
};

// Paint as car makers sell it: white, silver, black, red and a few others.
Color DrawCarPaint(Random& random);

}  // namespace recollect::simulation
