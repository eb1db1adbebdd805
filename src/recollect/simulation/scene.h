#pragma once

#include <embree3/rtcore.h>

#include <memory>
#include <vector>

#include "recollect/simulation/pictures.h"
#include "recollect/simulation/world.h"

namespace recollect::simulation {

// Rays are traced sixteen at a time.
constexpr int kPacket = 16;

// Where rays hit: mesh and quad, with the instance where the mesh is a model's.
struct Hit {
  const Mesh* mesh = nullptr;  // null: the sky
  std::uint32_t quad = 0;
  float u = 0, v = 0;  // bilinear place in the quad
  int instance = -1;   // index into Scene::instances() or, if moving, Movers::instances()
  bool moving = false;
};

// An instance with what shading needs of it.
struct PlacedInstance {
  Instance instance;
  Eigen::Affine3f model_from_world;
  explicit PlacedInstance(const Instance& i)
      : instance(i), model_from_world(i.world_from_model.inverse()) {}
};

class Movers;

// A world ready for ray tracing; it must outlive the scene. Tracing is thread-safe.
class Scene {
 public:
  Scene(const World& world, const PictureSet& pictures);
  ~Scene();
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  // Nearest hits of the rays with valid[i] = -1 (0: not traced). `spread` is the width of a pixel
  // at one metre; it chooses the detail of cut-outs. Fills hits[i] and rays.ray.tfar.
  void Intersect(RTCRayHit16& rays, const int* valid, float spread, const Movers* movers,
                 Hit* hits) const;
  // Sets tfar < 0 where something solid lies between ray origin and tfar.
  void Occluded(RTCRay16& rays, const int* valid, const Movers* movers) const;

  const World& world() const { return world_; }
  const std::vector<PlacedInstance>& instances() const { return instances_; }

 private:
  friend class Movers;
  struct Cutout;
  struct Layer;
  struct Source {
    int instance;  // -1: the world's own mesh
    std::uint32_t quad;
  };

  RTCScene Commit(const Mesh& solid, const Mesh& cutout,
                  const std::vector<PlacedInstance>& instances);
  RTCGeometry Place(const PlacedInstance& placed) const;

  const World& world_;
  const PictureSet& pictures_;
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
  std::vector<RTCScene> models_;
  std::vector<std::unique_ptr<Layer>> layers_;
  const Layer *solid_ = nullptr, *cutout_ = nullptr;  // of what stands
  std::vector<PlacedInstance> instances_;
};

// What moves, at one moment: instances of the scene's models.
class Movers {
 public:
  Movers(const Scene& scene, const std::vector<Instance>& instances);
  ~Movers();
  Movers(const Movers&) = delete;
  Movers& operator=(const Movers&) = delete;

  const std::vector<PlacedInstance>& instances() const { return instances_; }

 private:
  friend class Scene;
  RTCScene scene_ = nullptr;
  std::vector<PlacedInstance> instances_;
};

}  // namespace recollect::simulation
