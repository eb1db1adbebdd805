#include "recollect/simulation/scene.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "recollect/core/error.h"

namespace recollect::simulation {
namespace {

struct Context {
  RTCIntersectContext rtc;  // first: Embree hands this to the filter
  float spread = 0;
};

// Geometry numbers of a scene's own meshes; instances come after them.
constexpr unsigned kSolid = 0, kCutout = 1, kFirstInstance = 2;
constexpr int kShadowLevel = 2;  // mip level at which shadow rays see leaves

}  // namespace

struct Scene::Cutout {
  const Mesh* mesh;
  const Palette* palette;
  const PictureSet* pictures;

  // Turns down hits that fall into the holes of a cut-out texture.
  static void Filter(const RTCFilterFunctionNArguments* args) {
    const auto& self = *static_cast<const Cutout*>(args->geometryUserPtr);
    const float spread = reinterpret_cast<const Context*>(args->context)->spread;
    for (unsigned i = 0; i < args->N; ++i) {
      if (args->valid[i] != -1) continue;
      const Surface& surface = self.mesh->surfaces[RTCHitN_primID(args->hit, args->N, i)];
      const Texture& texture = (*self.pictures)[(*self.palette)[surface.material].picture];
      int level = kShadowLevel;
      if (spread > 0) {
        const float width = RTCRayN_tfar(args->ray, args->N, i) * spread * surface.gu.norm() *
                            static_cast<float>(texture.size());
        level = width > 1 ? static_cast<int>(std::bit_cast<std::uint32_t>(width) >> 23) - 127 : 0;
      }
      if (!texture.Solid(RTCHitN_u(args->hit, args->N, i), RTCHitN_v(args->hit, args->N, i),
                         level)) {
        args->valid[i] = 0;
      }
    }
  }
};

Scene::Scene(const World& world, const PictureSet& pictures) : world_(world), pictures_(pictures) {
  // One thread builds: the trees, and so the order of equally near hits, are always the same.
  device_ = rtcNewDevice("threads=1,set_affinity=0");
  Require(device_ != nullptr, "Embree", "the ray tracer does not start");
  for (const Model& model : world.models) {
    models_.push_back(Commit(model.solid, model.cutout));
    rtcCommitScene(models_.back());
  }
  scene_ = Commit(world.solid, world.cutout);
  for (const Instance& instance : world.instances) {
    instances_.emplace_back(instance);
    const RTCGeometry geometry = Place(instances_.back());
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(scene_);
  Require(rtcGetDeviceError(device_) == RTC_ERROR_NONE, "Embree", "building the scene failed");
}

Scene::~Scene() {
  if (scene_ != nullptr) rtcReleaseScene(scene_);
  for (const RTCScene model : models_) rtcReleaseScene(model);
  if (device_ != nullptr) rtcReleaseDevice(device_);
}

// A scene of two meshes, not yet committed. Empty meshes keep their number.
RTCScene Scene::Commit(const Mesh& solid, const Mesh& cutout) {
  const RTCScene scene = rtcNewScene(device_);
  for (const unsigned id : {kSolid, kCutout}) {
    const Mesh& mesh = id == kSolid ? solid : cutout;
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_QUAD);
    if (!mesh.quads.empty()) {
      // Embree reads vertices sixteen bytes at a time, so the last one needs room behind it.
      auto* vertices = static_cast<Vec3*>(
          rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                  sizeof(Vec3), mesh.vertices.size()));
      std::copy(mesh.vertices.begin(), mesh.vertices.end(), vertices);
      auto* quads = static_cast<std::array<std::uint32_t, 4>*>(rtcSetNewGeometryBuffer(
          geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 16, mesh.quads.size()));
      std::copy(mesh.quads.begin(), mesh.quads.end(), quads);
    }
    if (id == kCutout) {
      cutouts_.push_back(std::make_unique<Cutout>(&mesh, &world_.palette, &pictures_));
      rtcSetGeometryUserData(geometry, cutouts_.back().get());
      rtcSetGeometryIntersectFilterFunction(geometry, &Cutout::Filter);
      rtcSetGeometryOccludedFilterFunction(geometry, &Cutout::Filter);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, id);
    rtcReleaseGeometry(geometry);
  }
  return scene;
}

RTCGeometry Scene::Place(const PlacedInstance& placed) const {
  const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(geometry,
                               models_.at(static_cast<std::size_t>(placed.instance.model)));
  const Eigen::Matrix<float, 3, 4> matrix = placed.instance.world_from_model.matrix().topRows<3>();
  rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, matrix.data());
  rtcCommitGeometry(geometry);
  return geometry;
}

void Scene::Intersect(RTCRayHit16& rays, const int* valid, float spread, const Movers* movers,
                      Hit* hits) const {
  Context context;
  rtcInitIntersectContext(&context.rtc);
  context.spread = spread;
  std::fill_n(rays.hit.geomID, kPacket, RTC_INVALID_GEOMETRY_ID);
  std::fill_n(rays.hit.instID[0], kPacket, RTC_INVALID_GEOMETRY_ID);
  rtcIntersect16(valid, scene_, &context.rtc, &rays);
  std::array<float, kPacket> still;
  std::copy_n(rays.ray.tfar, kPacket, still.begin());
  if (movers != nullptr && !movers->instances_.empty()) {
    rtcInitIntersectContext(&context.rtc);
    rtcIntersect16(valid, movers->scene_, &context.rtc, &rays);
  }
  for (int i = 0; i < kPacket; ++i) {
    hits[i] = {};
    if (valid[i] == 0 || rays.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
    Hit& hit = hits[i];
    hit.moving = rays.ray.tfar[i] < still[static_cast<std::size_t>(i)];
    hit.quad = rays.hit.primID[i];
    hit.u = rays.hit.u[i];
    hit.v = rays.hit.v[i];
    const bool solid = rays.hit.geomID[i] == kSolid;
    const unsigned instance = rays.hit.instID[0][i];
    if (instance == RTC_INVALID_GEOMETRY_ID) {
      hit.mesh = solid ? &world_.solid : &world_.cutout;
    } else {
      hit.instance = static_cast<int>(instance - (hit.moving ? 0 : kFirstInstance));
      const auto& all = hit.moving ? movers->instances_ : instances_;
      const auto model = all[static_cast<std::size_t>(hit.instance)].instance.model;
      const Model& m = world_.models[static_cast<std::size_t>(model)];
      hit.mesh = solid ? &m.solid : &m.cutout;
    }
  }
}

void Scene::Occluded(RTCRay16& rays, const int* valid, const Movers* movers) const {
  Context context;
  rtcInitIntersectContext(&context.rtc);
  rtcOccluded16(valid, scene_, &context.rtc, &rays);
  if (movers == nullptr || movers->instances_.empty()) return;
  std::array<int, kPacket> open;
  for (int i = 0; i < kPacket; ++i) {
    open[static_cast<std::size_t>(i)] = valid[i] != 0 && rays.tfar[i] >= 0 ? -1 : 0;
  }
  rtcInitIntersectContext(&context.rtc);
  rtcOccluded16(open.data(), movers->scene_, &context.rtc, &rays);
}

Movers::Movers(const Scene& scene, const std::vector<Instance>& instances) {
  for (const Instance& instance : instances) instances_.emplace_back(instance);
  scene_ = rtcNewScene(scene.device_);
  for (std::size_t i = 0; i < instances_.size(); ++i) {
    const RTCGeometry geometry = scene.Place(instances_[i]);
    rtcAttachGeometryByID(scene_, geometry, static_cast<unsigned>(i));
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(scene_);
}

Movers::~Movers() { rtcReleaseScene(scene_); }

}  // namespace recollect::simulation
