#include "recollect/simulation/stock.h"

#include <array>

namespace recollect::simulation {

Stock::Stock(Palette& palette) {
  const auto add = [&](Picture picture, const Color& tint, float tile, float gloss = 0,
                       float patchiness = 0) {
    return palette.Add(
        {.picture = picture, .tint = tint, .tile = tile, .gloss = gloss, .patchiness = patchiness});
  };
  const auto ground = [&](Picture picture, const Color& tint, float tile, float patchiness) {
    return palette.Add(
        {.picture = picture, .tint = tint, .tile = tile, .patchiness = patchiness, .ground = true});
  };
  const auto leaves = [&](Picture picture, const Color& tint) {
    return palette.Add({.picture = picture, .tint = tint, .patchiness = 0.3F, .foliage = true});
  };
  const auto gray = [](float x) { return Color(x, x, x); };

  kerb = ground(Picture::kConcrete, gray(0.9F), 1.7F, 0.5F);
  white_paint = ground(Picture::kRoadPaint, gray(1), 1.3F, 0.3F);
  yellow_paint = ground(Picture::kRoadPaint, {1, 0.66F, 0.16F}, 1.3F, 0.3F);
  old_concrete = add(Picture::kConcrete, {0.85F, 0.82F, 0.76F}, 3.1F, 0, 0.6F);
  dark = add(Picture::kPlain, gray(0.02F), 1);
  manhole = ground(Picture::kMetal, gray(0.3F), 0.8F, 0);
  grass = add(Picture::kGrass, gray(1), 3.7F, 0, 0.8F);
  earth = ground(Picture::kEarth, gray(1), 4.3F, 0.7F);
  gravel = ground(Picture::kGravel, gray(1), 2.3F, 0.5F);
  slabs = ground(Picture::kSlabs, gray(1), 4, 0.6F);
  pavers = ground(Picture::kPavers, gray(1), 2, 0.6F);
  forest = add(Picture::kForest, gray(1), 90, 0, 0.7F);
  hedge =
      palette.Add({.picture = Picture::kHedge, .tile = 1.9F, .patchiness = 0.6F, .foliage = true});
  bark = add(Picture::kBark, gray(1), 1.2F);
  steel = add(Picture::kMetal, {1.0F, 1.02F, 1.05F}, 3, 0.15F, 0.3F);
  rust = add(Picture::kMetal, {0.7F, 0.5F, 0.38F}, 2, 0, 0.4F);
  wood = add(Picture::kWood, gray(1), 1.5F, 0, 0.3F);
  white = add(Picture::kPlaster, gray(1), 2.7F, 0, 0.2F);
  black = add(Picture::kPlain, gray(0.03F), 1, 0.1F);
  rubber = add(Picture::kPlain, gray(0.025F), 1);
  glass = add(Picture::kWindows, gray(0.35F), 4, 1);
  window_frame = add(Picture::kPlain, gray(0.5F), 1, 0.1F);
  windows = add(Picture::kWindows, gray(0.8F), 1, 0.8F);
  signs = add(Picture::kSigns, gray(1), 1);
  posters = add(Picture::kPosters, gray(1), 1);
  traffic_signs = add(Picture::kTrafficSigns, gray(1), 1, 0.1F);
  paint = palette.Add({.picture = Picture::kPlain, .gloss = 0.55F, .repaint = true});
  chrome = add(Picture::kPlain, gray(0.35F), 1, 0.6F);
  car_glass = add(Picture::kPlain, gray(0.03F), 1, 1);
  head_lamp = add(Picture::kPlain, gray(0.75F), 1, 0.8F);
  tail_lamp = add(Picture::kPlain, {0.45F, 0.02F, 0.02F}, 1, 0.6F);
  broad_leaves = leaves(Picture::kBroadLeaves, gray(1.15F));
  fine_leaves = leaves(Picture::kFineLeaves, gray(1.15F));
  long_leaves = leaves(Picture::kLongLeaves, {1.1F, 1.1F, 1.3F});
  palm_frond = leaves(Picture::kPalmFrond, gray(1.25F));
  blossom = leaves(Picture::kBlossom, gray(1));
  grass_tuft = leaves(Picture::kGrassTuft, gray(1));
  wire_mesh = palette.Add({.picture = Picture::kWireMesh, .gloss = 0.1F});
}

Color DrawPaint(Random& random) {
  static const std::array<Color, 12> kStrong = {
      Color(0.55F, 0.10F, 0.07F), Color(0.08F, 0.16F, 0.45F), Color(0.75F, 0.45F, 0.08F),
      Color(0.10F, 0.30F, 0.14F), Color(0.80F, 0.62F, 0.20F), Color(0.30F, 0.52F, 0.62F),
      Color(0.62F, 0.28F, 0.14F), Color(0.40F, 0.12F, 0.30F), Color(0.72F, 0.40F, 0.34F),
      Color(0.20F, 0.40F, 0.40F), Color(0.50F, 0.46F, 0.30F), Color(0.15F, 0.15F, 0.17F)};
  const double kind = random.Uniform();
  const float light = Draw(random, 0.45, 1.0);
  if (kind < 0.3) return Color(1.0F, 0.99F, 0.96F) * light;
  if (kind < 0.6) {
    return Color(Draw(random, 0.75, 1), Draw(random, 0.7, 0.95), Draw(random, 0.5, 0.85)) * light;
  }
  return kStrong[static_cast<std::size_t>(random.Index(12))] * (0.75F + 0.6F * light);
}

}  // namespace recollect::simulation
