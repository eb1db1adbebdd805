#pragma once

#include <embree3/rtcore.h>

#include <array>
#include <memory>
#include <vector>

#include "recollect/simulation/packet.h"
#include "recollect/simulation/pictures.h"
#include "recollect/simulation/world.h"

namespace recollect::simulation {

class Movers;

// A world ready for ray tracing; it must outlive the scene. Tracing is thread-safe.
class Scene {
 public:
  Scene(const World& world, const PictureSet& pictures);
  ~Scene();
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  // Nearest hits of the rays with valid[i] = -1 (0: not traced). `spread` is the width of a pixel
  // at one metre; it chooses the detail of cut-outs. Fills rays.ray.tfar and records[i]: its flag
  // kSky tells that nothing was hit.
  void Intersect(RTCRayHit16& rays, const int* valid, float spread, const Movers* movers,
                 SurfaceRecord* records) const;
  // Sets tfar < 0 where something solid lies between ray origin and tfar.
  void Occluded(RTCRay16& rays, const int* valid, const Movers* movers) const;

 private:
  friend class Movers;
  struct Cutout;
  struct Layer;
  struct Source {
    int instance;  // -1: the world's own mesh
    std::uint32_t quad;
  };

  RTCScene Commit(const Mesh& solid, const Mesh& cutout, const std::vector<Instance>& instances,
                  bool standing);
  RTCGeometry Place(const Instance& placed) const;
  const Mesh& MeshOf(const Instance* placed, bool solid) const;

  const World& world_;
  const PictureSet& pictures_;
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
  std::vector<RTCScene> models_;
  std::vector<std::unique_ptr<Layer>> layers_;
  const Layer *solid_ = nullptr, *cutout_ = nullptr;   // of what stands
  std::array<std::vector<SurfaceRecord>, 2> records_;  // of all quads that stand
};

// What moves, at one moment: instances of the scene's models.
class Movers {
 public:
  Movers(const Scene& scene, const std::vector<Instance>& instances);
  ~Movers();
  Movers(const Movers&) = delete;
  Movers& operator=(const Movers&) = delete;

 private:
  friend class Scene;
  RTCScene scene_ = nullptr;
  std::vector<Instance> instances_;
};

}  // namespace recollect::simulation
