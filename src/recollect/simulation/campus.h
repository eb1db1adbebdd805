#pragma once

#include "recollect/simulation/day.h"
#include "recollect/simulation/planner.h"
#include "recollect/simulation/route.h"
#include "recollect/simulation/site.h"

namespace recollect::simulation {

// The land and streets of a route: the same on all days.
struct Campus {
  std::uint64_t seed;
  std::vector<Street> streets;
  Site site;

  Campus(const Route& route, std::uint64_t campus_seed);
};

// A campus as it stands on one day, and the models that may move through it.
struct CampusDay {
  World world;
  Vehicles vehicles;
};
CampusDay BuildCampus(const Campus& campus, const Day& day);

}  // namespace recollect::simulation
