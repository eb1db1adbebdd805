#pragma once

#include "recollect/simulation/stock.h"

namespace recollect::simulation {

// What a building looks like; drawn at random, so that no two are alike. Metres.
struct BuildingPlan {
  enum class Windows { kPunched, kRibbon, kTall, kGrid, kSmall };
  enum class Roof { kFlat, kGable, kHip, kVault, kSawtooth };

  float width = 20, depth = 12;  // along its front and back from it
  int floors = 2;
  float floor_height = 3.3F;
  int wall = 0, accent = 0, roof_material = 0;  // materials
  Windows windows = Windows::kPunched;
  Roof roof = Roof::kFlat;
  float window_width = 1.4F, window_height = 1.4F, sill = 0.95F, bay = 3;
  bool stilts = false;                       // the ground floor open, on columns
  bool fins = false;                         // upright concrete blades before the windows
  bool louvres = false;                      // level ones
  bool bands = false;                        // floors marked by strips of the accent
  float balcony_share = 0, blank_share = 0;  // of the window bays
  bool portico = false, shopfront = false, sign = true, mural = false, wing = false;
  std::uint64_t seed = 0;

  float height() const { return static_cast<float>(floors) * floor_height; }
};

// A plan for a plot at most `width` along the street and `depth` back from it. Walls and paint are
// new materials of the palette. `repaints` is how often it has been painted over.
BuildingPlan DrawBuilding(std::uint64_t seed, int repaints, float width, float depth, bool tall,
                          Palette& palette);

// Builds it: its front looks along -y of the builder's frame, centred on x = 0, y = 0, and stands
// at z = 0 (walls go on 1.5 m below).
void BuildBuilding(const BuildingPlan& plan, const Stock& stock, MeshBuilder& build);

}  // namespace recollect::simulation
