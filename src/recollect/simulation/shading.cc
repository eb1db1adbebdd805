#include "recollect/simulation/shading.h"

#include <algorithm>
#include <cmath>

#include "recollect/simulation/noise.h"

namespace recollect::simulation {
namespace {

Vec3 SmoothNormal(const Mesh& mesh, const Hit& hit) {
  const auto& quad = mesh.quads[hit.quad];
  const float u = hit.u, v = hit.v;
  return mesh.normals[quad[0]] * ((1 - u) * (1 - v)) + mesh.normals[quad[1]] * (u * (1 - v)) +
         mesh.normals[quad[2]] * (u * v) + mesh.normals[quad[3]] * ((1 - u) * v);
}

// Slow variation over metres and tens of metres, about 1.
float Patches(const PictureSet& pictures, const Vec3& p, float strength, float footprint) {
  const Texture& noise = pictures.variation();
  const float x = p.x() + 0.6F * p.z(), y = p.y() - 0.8F * p.z();
  const float broad = noise.Smooth(x / 61, y / 61, footprint / 61).x();
  const float fine = noise.Smooth(x / 11.3F, y / 11.3F, footprint / 11.3F).y();
  return 1 + strength * (0.7F * broad + 0.6F * fine - 0.65F);
}

}  // namespace

Shaded Surfaced(const Scene& scene, const PictureSet& pictures, float wetness, const Hit& hit,
                const std::vector<PlacedInstance>& instances, const Vec3& point, const Vec3& d,
                float distance, float spread) {
  const Surface& surface = hit.mesh->surfaces[hit.quad];
  const Material& material = scene.world().palette[surface.material];
  const PlacedInstance* placed =
      hit.instance >= 0 ? &instances[static_cast<std::size_t>(hit.instance)] : nullptr;
  Shaded out;
  Vec3 local = point, local_d = d;
  Vec3 normal = hit.mesh->normals.empty() ? surface.normal : SmoothNormal(*hit.mesh, hit);
  if (placed != nullptr) {
    local = placed->model_from_world * point;
    local_d = placed->model_from_world.linear() * d;  // scaled: carries the footprint's scale too
    normal = (placed->instance.world_from_model.linear() * normal).normalized();
  }
  const float facing = normal.dot(d);
  out.foliage = material.foliage;
  out.normal = facing > 0 && !material.foliage ? Vec3(-normal) : normal;
  out.openness = surface.openness;

  // The pixel's footprint: `width` across, longer by the slant along the line of sight.
  const float width = distance * spread;
  const float scale = local_d.norm();
  const float slant = std::max(0.06F, std::abs(surface.normal.dot(local_d)) / scale);
  const Vec3 across = local_d.cross(surface.normal).normalized() * (width * scale);
  Vec3 along = local_d - surface.normal * surface.normal.dot(local_d);
  along *= width / std::max(slant, 1e-3F) / std::max(along.norm() / scale, 1e-6F);
  const Vec2 span(surface.gu.dot(across), surface.gv.dot(across));
  const float minor = span.norm();
  const float u = surface.gu.dot(local) + surface.u0, v = surface.gv.dot(local) + surface.v0;
  out.albedo = material.tint * pictures[material.picture].Sample(u, v, minor, surface.gu.dot(along),
                                                                 surface.gv.dot(along));
  if (placed != nullptr && (material.repaint || material.foliage)) {
    out.albedo *= placed->instance.tint;
  }
  if (material.patchiness > 0) {
    out.albedo *= Patches(pictures, point, material.patchiness, width / slant);
  }
  out.gloss = material.gloss;
  if (wetness > 0 && material.ground) {
    const float puddle = SmoothStep(
        0.45F, 0.6F, pictures.variation().Smooth(point.x() / 19, point.y() / 19, width / 19).x());
    out.albedo *= 1 - wetness * 0.45F;
    out.gloss = std::max(out.gloss, wetness * (0.25F + 0.75F * puddle));
  }
  out.id = static_cast<std::uint32_t>(surface.material) * 64 +
           static_cast<std::uint32_t>(hit.instance + 1) * 4096;
  if (!material.foliage) {
    const auto bits = [](float x) { return static_cast<std::uint32_t>(x * 1.5F + 2); };
    out.id += bits(out.normal.x()) * 16 + bits(out.normal.y()) * 4 + bits(out.normal.z());
  } else {
    out.id = static_cast<std::uint32_t>(surface.material) * 64;
  }
  return out;
}

Color Lit(const Sky& sky, const Shaded& s, const Vec3& d, float distance, float sunlit) {
  const float toward = s.normal.dot(sky.to_sun());
  Color light = sky.Ambient(s.normal) * s.openness;
  if (sunlit > 0) {
    if (s.foliage) {  // leaves scatter: lit from in front and, greener, from behind
      const float wrapped = 0.25F + 0.75F * std::max(0.0F, toward);
      light += sky.sun() * (sunlit * wrapped * (0.45F + 0.55F * s.openness));
    } else {
      light += sky.sun() * (sunlit * std::max(0.0F, toward));
    }
  }
  Color color = s.albedo * light;
  if (s.gloss > 0) {
    const float facing = std::min(1.0F, std::abs(s.normal.dot(d)));
    const float away = 1 - facing, grazing = away * away * away * away * away;
    const float share = s.gloss * (0.05F + 0.9F * grazing);
    const Vec3 mirrored = d - 2 * s.normal.dot(d) * s.normal;
    color = color * (1 - share) + sky.Reflection(mirrored) * share;
    const float glint = std::max(0.0F, mirrored.dot(sky.to_sun()));
    if (sunlit > 0 && glint > 0.9F) {
      color += sky.sun() * (s.gloss * sunlit * 1.5F * std::pow(glint, 180.0F));
    }
  }
  const float clear = sky.HazeShare(distance);
  return color * clear + sky.Haze(d) * (1 - clear);
}

}  // namespace recollect::simulation
