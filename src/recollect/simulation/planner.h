#pragma once

#include <vector>

#include "recollect/simulation/day.h"
#include "recollect/simulation/plants.h"
#include "recollect/simulation/site.h"
#include "recollect/simulation/vehicles.h"

namespace recollect::simulation {

// A place beside a street: x along the street, y away from it, z up, origin on the ground.
struct Spot {
  Eigen::Isometry3f world_from_spot = Eigen::Isometry3f::Identity();

  Vec2 At(float x, float y) const { return (world_from_spot * Vec3(x, y, 0)).head<2>(); }
  float heading() const {
    const auto& R = world_from_spot.linear();
    return std::atan2(R(1, 0), R(0, 0));
  }
};

// What fills a site with things. Ground is claimed alike on all days, whether or not a thing stands
// there on this one: so what changes never moves its neighbours.
class Planner {
 public:
  Planner(const std::vector<Street>& streets, Site& site, const Day& day, std::uint64_t seed,
          const Stock& stock, const Plants& plants, const Vehicles& vehicles, World& world);

  const std::vector<Street>& streets;
  Site& site;
  const Day& day;
  const std::uint64_t seed;
  const Stock& stock;
  const Plants& plants;
  const Vehicles& vehicles;
  World& world;
  MeshBuilder build;  // into world.solid

  // The place `off` metres outside the edge of the road (bays included), `s` metres along it.
  Spot Beside(const Street& street, float s, bool left, float off) const;
  // Sets the builder on the ground at a place of a spot, turned by `turn` radians.
  void StandAt(const Spot& spot, float x, float y, float turn = 0);

  // One plant of the list, where there is room; absent on days after it was cut.
  void Plant(const std::vector<int>& list, std::uint64_t id, const Vec2& at, float scale = 1);
  // A parked vehicle, there or not as the day has it; `likely` is its chance to be there.
  void Park(std::uint64_t id, const Vec3& at, float heading, double likely);
  void Place(int model, const Vec3& at, float heading, float scale, const Color& tint);
  // A patch of another ground, laid upon the land: x0..x1, y0..y1 of the spot.
  void Pave(const Spot& spot, const Vec2& low, const Vec2& high, int material, float lift = 0.05F);
  // A row of posts with wire mesh between, from one place of a spot to another.
  void Fence(const Spot& spot, const Vec2& from, const Vec2& to, float height);
  // A solid wall or hedge of some thickness along the way between two places of a spot.
  void Wall(const Spot& spot, const Vec2& from, const Vec2& to, float height, float thickness,
            int material);

  // Whether the thing stands on this day; it comes and goes `rate` times a year.
  bool Stands(std::uint64_t id, double rate) const { return day.Changes(id, rate) % 2 == 0; }
  bool Claim(const Spot& spot, const Vec2& low, const Vec2& high);

 private:
  std::vector<float> low_reach_;  // by model: how far it spreads below 2.8 m
};

// Parcels of land on both sides of the streets: buildings, groves, plazas, courts, car parks.
void FillParcels(Planner& planner);
// What stands along the kerb: lamps, poles and wires, signs, bins, bus stops, parked cars.
void LineStreets(Planner& planner);

}  // namespace recollect::simulation
