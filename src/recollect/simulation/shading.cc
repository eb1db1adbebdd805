#include "recollect/simulation/shading.h"

namespace recollect::simulation {
namespace {

template <typename Triple>
void Keep(const Triple& from, float* to) {
  for (int k = 0; k < 3; ++k) to[k] = from[k];
}

Vec3 InWorld(const Vec3& normal, const Instance* placed) {
  return placed == nullptr ? normal
                           : Vec3((placed->world_from_model.linear() * normal).normalized());
}

}  // namespace

SurfaceRecord MakeRecord(const Palette& palette, const Mesh& mesh, std::uint32_t quad,
                         const Instance* placed, int number) {
  const Surface& surface = mesh.surfaces[quad];
  const Material& material = palette[surface.material];
  SurfaceRecord r{};
  Vec3 gu = surface.gu, gv = surface.gv;
  r.u0 = surface.u0;
  r.v0 = surface.v0;
  Color tint = material.tint;
  if (placed != nullptr) {
    const Eigen::Affine3f model_from_world = placed->world_from_model.inverse();
    r.u0 += gu.dot(model_from_world.translation());
    r.v0 += gv.dot(model_from_world.translation());
    gu = model_from_world.linear().transpose() * gu;
    gv = model_from_world.linear().transpose() * gv;
    if (material.repaint || material.foliage) tint *= placed->tint;
  }
  Vec3 shading = surface.normal;
  if (!mesh.normals.empty()) {
    const auto& corners = mesh.quads[quad];
    shading = mesh.normals[corners[0]];
    for (const std::uint32_t c : corners) {
      if (mesh.normals[c] != shading) r.flags |= SurfaceRecord::kSmooth;
    }
  }
  Keep(InWorld(surface.normal, placed), r.normal);
  Keep(InWorld(shading, placed), r.shading_normal);
  Keep(gu, r.gu);
  Keep(gv, r.gv);
  Keep(tint, r.tint);
  r.openness = surface.openness;
  r.gloss = material.gloss;
  r.patchiness = material.patchiness;
  r.picture = static_cast<std::int32_t>(material.picture);
  if (material.foliage) r.flags |= SurfaceRecord::kFoliage;
  if (material.ground) r.flags |= SurfaceRecord::kGround;
  r.id = surface.material * 64 + (material.foliage ? 0 : (number + 1) * 4096) + 1;
  return r;
}

void BendNormal(const Mesh& mesh, std::uint32_t quad, float u, float v, const Instance* placed,
                SurfaceRecord& record) {
  const auto& n = mesh.normals;
  const auto& corner = mesh.quads[quad];
  const Vec3 normal = n[corner[0]] * ((1 - u) * (1 - v)) + n[corner[1]] * (u * (1 - v)) +
                      n[corner[2]] * (u * v) + n[corner[3]] * ((1 - u) * v);
  Keep(InWorld(normal, placed), record.shading_normal);
}

}  // namespace recollect::simulation
