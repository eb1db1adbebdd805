#include <algorithm>
#include <array>

#include "recollect/simulation/building.h"

namespace recollect::simulation {
namespace {

int DrawWall(Random& random, Random& paint, Palette& palette) {
  struct Kind {
    Picture picture;
    float tile;
    bool painted;
    double share;
  };
  constexpr std::array<Kind, 8> kKinds = {{{Picture::kPlaster, 5.3F, true, 0.38},
                                           {Picture::kBrick, 2.1F, false, 0.14},
                                           {Picture::kConcrete, 4.7F, false, 0.10},
                                           {Picture::kBoardConcrete, 4.0F, false, 0.10},
                                           {Picture::kTiles, 2.4F, true, 0.10},
                                           {Picture::kStone, 3.6F, false, 0.05},
                                           {Picture::kMetal, 4.0F, true, 0.05},
                                           {Picture::kConcrete, 4.3F, true, 0.08}}};
  double u = random.Uniform();
  std::size_t k = 0;
  while (k + 1 < kKinds.size() && u > kKinds[k].share) u -= kKinds[k++].share;
  const Color tint =
      kKinds[k].painted ? DrawPaint(paint) : Color(Color::Constant(Draw(random, 0.75, 1.3)));
  return palette.Add({.picture = kKinds[k].picture,
                      .tint = tint,
                      .tile = kKinds[k].tile * Draw(random, 0.85, 1.2),
                      .gloss = kKinds[k].picture == Picture::kTiles ? 0.2F : 0.0F,
                      .patchiness = Draw(random, 0.25, 0.6)});
}

}  // namespace

BuildingPlan DrawBuilding(std::uint64_t seed, int repaints, float width, float depth, bool tall,
                          Palette& palette) {
  Random random(SubSeed(seed, 1));
  Random paint(SubSeed(SubSeed(seed, 2), static_cast<std::uint64_t>(repaints)));
  BuildingPlan plan;
  plan.seed = SubSeed(seed, 3);
  plan.width = std::min(width, Draw(random, 9, 48));
  plan.depth = std::min(depth, Draw(random, 8, 18));
  plan.floors = tall ? static_cast<int>(4 + random.Index(7))
                     : static_cast<int>(1 + random.Index(random.Uniform() < 0.2 ? 5 : 3));
  plan.floor_height = Draw(random, 2.9, 3.9);
  plan.wall = DrawWall(random, paint, palette);
  plan.accent = palette.Add(
      {.picture = Picture::kPlaster, .tint = DrawPaint(paint), .tile = 3.1F, .patchiness = 0.3F});
  using Windows = BuildingPlan::Windows;
  using Roof = BuildingPlan::Roof;
  plan.windows = static_cast<Windows>(random.Index(5));
  switch (plan.windows) {
    case Windows::kPunched:
      plan.bay = Draw(random, 2.4, 4.2);
      plan.window_width = Draw(random, 1.0, 1.8);
      plan.window_height = Draw(random, 1.1, 1.6);
      break;
    case Windows::kRibbon:
      plan.bay = Draw(random, 1.6, 2.6);
      plan.window_width = plan.bay - 0.12F;
      plan.window_height = Draw(random, 0.9, 1.5);
      plan.sill = 1.1F;
      break;
    case Windows::kTall:
      plan.bay = Draw(random, 1.8, 3.2);
      plan.window_width = Draw(random, 0.8, 1.2);
      plan.window_height = plan.floor_height - 0.7F;
      plan.sill = 0.3F;
      break;
    case Windows::kGrid:
      plan.bay = Draw(random, 1.5, 2.2);
      plan.window_width = plan.bay - 0.25F;
      plan.window_height = plan.floor_height - 0.9F;
      plan.sill = 0.6F;
      break;
    default:
      plan.bay = Draw(random, 3.0, 5.5);
      plan.window_width = Draw(random, 0.7, 1.3);
      plan.window_height = Draw(random, 0.5, 0.9);
      plan.sill = plan.floor_height - 1.5F;
  }
  const double roof = random.Uniform();
  if (plan.floors > 3 || roof < 0.5) {
    plan.roof = Roof::kFlat;
  } else if (roof < 0.7) {
    plan.roof = Roof::kGable;
  } else if (roof < 0.85) {
    plan.roof = Roof::kHip;
  } else {
    plan.roof = roof < 0.93 ? Roof::kVault : Roof::kSawtooth;
  }
  const bool tiled = plan.roof == Roof::kGable || plan.roof == Roof::kHip;
  plan.roof_material = palette.Add({.picture = tiled ? Picture::kRoofTiles : Picture::kMetal,
                                    .tint = Color::Constant(Draw(random, 0.7, 1.3)),
                                    .tile = 3.0F,
                                    .patchiness = 0.5F});
  plan.stilts = plan.floors >= 2 && random.Uniform() < 0.22;
  plan.fins = random.Uniform() < 0.22;
  plan.louvres = !plan.fins && random.Uniform() < 0.2;
  plan.bands = random.Uniform() < 0.4;
  plan.balcony_share = random.Uniform() < 0.25 ? Draw(random, 0.2, 0.6) : 0;
  plan.blank_share = Draw(random, 0, 0.25);
  plan.portico = random.Uniform() < 0.45;
  plan.shopfront = !plan.stilts && random.Uniform() < 0.3;
  plan.sign = random.Uniform() < 0.7;
  plan.mural = random.Uniform() < 0.22;
  plan.wing = plan.width > 20 && random.Uniform() < 0.35;
  return plan;
}

}  // namespace recollect::simulation
