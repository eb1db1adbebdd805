#pragma once

#include "recollect/simulation/day.h"
#include "recollect/simulation/site.h"
#include "recollect/simulation/stock.h"

namespace recollect::simulation {

// Carriageways with markings, patches, crossings and speed bumps; kerbs and pavements beside them.
void BuildRoads(const std::vector<Street>& streets, const Site& site, const Day& day,
                std::uint64_t seed, const Stock& stock, World& world);

// The land around, and the hills on the horizon.
void BuildTerrain(const Site& site, const Day& day, std::uint64_t seed, const Stock& stock,
                  World& world);

// Width of the verge or pavement beside the kerb `s` metres along a street.
float VergeWidth(const Street& street, std::uint64_t street_seed, float s, bool left);

}  // namespace recollect::simulation
