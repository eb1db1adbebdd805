#include "recollect/simulation/campus.h"

#include "recollect/simulation/roadworks.h"

namespace recollect::simulation {

Campus::Campus(const Route& route, std::uint64_t campus_seed)
    : seed(campus_seed),
      streets(LayStreets(route, SubSeed(seed, 1))),
      site(route, streets, SubSeed(seed, 2)) {}

CampusDay BuildCampus(const Campus& campus, const Day& day) {
  CampusDay result;
  World& world = result.world;
  const Stock stock(world.palette);
  const Plants plants(SubSeed(campus.seed, 3), stock, world);
  result.vehicles = Vehicles(SubSeed(campus.seed, 4), stock, world);
  Site site = campus.site.Copy();
  Planner planner(campus.streets, site, day, SubSeed(campus.seed, 5), stock, plants,
                  result.vehicles, world);
  LineStreets(planner);
  FillParcels(planner);
  BuildRoads(campus.streets, campus.site, day, SubSeed(campus.seed, 6), stock, world);
  BuildTerrain(campus.site, day, SubSeed(campus.seed, 7), stock, world);
  return result;
}

}  // namespace recollect::simulation
