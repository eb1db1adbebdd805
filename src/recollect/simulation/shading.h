#pragma once

#include "recollect/simulation/packet.h"
#include "recollect/simulation/world.h"

namespace recollect::simulation {

// What shading needs of quad `quad` of a mesh; `placed`: the instance it belongs to, `number`th of
// its scene, or null for the world's own mesh.
SurfaceRecord MakeRecord(const Palette& palette, const Mesh& mesh, std::uint32_t quad,
                         const Instance* placed, int number);

// Sets the shading normal at bilinear place (u, v) of a quad whose corners differ in it (kSmooth).
void BendNormal(const Mesh& mesh, std::uint32_t quad, float u, float v, const Instance* placed,
                SurfaceRecord& record);

}  // namespace recollect::simulation
