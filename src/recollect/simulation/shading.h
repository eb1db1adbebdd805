#pragma once

#include "recollect/simulation/scene.h"
#include "recollect/simulation/sky.h"

namespace recollect::simulation {

// A point of a surface as one pixel sees it.
struct Shaded {
  Vec3 normal = Vec3::UnitZ();  // towards the viewer, unless leafy
  Color albedo = Color::Zero();
  float gloss = 0, openness = 1;
  bool foliage = false;
  std::uint32_t id = 0;  // differs where an outline runs between two pixels
};

// Normal, colour and finish at a hit seen along unit direction `d` from `distance` metres, by a
// pixel `spread` metres wide at one metre.
Shaded Surfaced(const Scene& scene, const PictureSet& pictures, float wetness, const Hit& hit,
                const std::vector<PlacedInstance>& instances, const Vec3& point, const Vec3& d,
                float distance, float spread);

// Light from the point towards the viewer; `sunlit` is 0 in shadow, 1 in the sun.
Color Lit(const Sky& sky, const Shaded& surface, const Vec3& d, float distance, float sunlit);

}  // namespace recollect::simulation
