#include "recollect/simulation/scene.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "recollect/core/error.h"
#include "recollect/simulation/shading.h"

namespace recollect::simulation {
namespace {

struct Context {
  RTCIntersectContext rtc;  // first: Embree hands this to the filter
  float spread = 0;

  explicit Context(float width, RTCIntersectContextFlags flags) : spread(width) {
    rtcInitIntersectContext(&rtc);
    rtc.flags = flags;
  }
};

// Neighbouring pixels' rays go the same way through what stands. Instances of what moves are not
// traced so: Embree 3.13 does not always come back from it.
constexpr auto kTogether = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
constexpr auto kApart = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;

// Geometry numbers in every scene.
constexpr unsigned kSolid = 0, kCutout = 1;
constexpr int kShadowLevel = 2;  // mip level at which shadow rays see leaves

}  // namespace

struct Scene::Cutout {
  const Texture* texture;
  float texels;  // along one metre
};

// Quads of a scene's own or of a model, with what it takes to know them again.
struct Scene::Layer {
  std::vector<Source> sources;  // of each quad
  std::vector<Cutout> cutouts;  // of each quad, where they are cut out

  // Turns down hits that fall into the holes of a cut-out texture.
  static void Filter(const RTCFilterFunctionNArguments* args) {
    const auto& cutouts = static_cast<const Layer*>(args->geometryUserPtr)->cutouts;
    const float spread = reinterpret_cast<const Context*>(args->context)->spread;
    for (unsigned i = 0; i < args->N; ++i) {
      if (args->valid[i] != -1) continue;
      const Cutout& cutout = cutouts[RTCHitN_primID(args->hit, args->N, i)];
      int level = kShadowLevel;
      if (spread > 0) {
        const float width = RTCRayN_tfar(args->ray, args->N, i) * spread * cutout.texels;
        level = width > 1 ? static_cast<int>(std::bit_cast<std::uint32_t>(width) >> 23) - 127 : 0;
      }
      if (!cutout.texture->Solid(RTCHitN_u(args->hit, args->N, i), RTCHitN_v(args->hit, args->N, i),
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
    models_.push_back(Commit(model.solid, model.cutout, {}, false));
  }
  // All that stands is one tree of quads: rays would visit the boxes of instances, which overlap
  // where crowns do, one after the other.
  scene_ = Commit(world.solid, world.cutout, world.instances, true);
  cutout_ = layers_.back().get();
  solid_ = layers_[layers_.size() - 2].get();
  Require(rtcGetDeviceError(device_) == RTC_ERROR_NONE, "Embree", "building the scene failed");
}

Scene::~Scene() {
  if (scene_ != nullptr) rtcReleaseScene(scene_);
  for (const RTCScene model : models_) rtcReleaseScene(model);
  if (device_ != nullptr) rtcReleaseDevice(device_);
}

// A scene of two meshes and of copies of models. Empty meshes keep their number.
RTCScene Scene::Commit(const Mesh& solid, const Mesh& cutout,
                       const std::vector<Instance>& instances, bool standing) {
  const RTCScene scene = rtcNewScene(device_);
  if (standing) rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
  for (const unsigned id : {kSolid, kCutout}) {
    std::vector<std::pair<const Mesh*, int>> parts = {{id == kSolid ? &solid : &cutout, -1}};
    for (std::size_t i = 0; i < instances.size(); ++i) {
      const Model& model = world_.models.at(static_cast<std::size_t>(instances[i].model));
      parts.emplace_back(id == kSolid ? &model.solid : &model.cutout, static_cast<int>(i));
    }
    std::size_t vertices = 0, quads = 0;
    for (const auto& [mesh, instance] : parts) {
      vertices += mesh->vertices.size();
      quads += mesh->quads.size();
    }
    layers_.push_back(std::make_unique<Layer>());
    Layer& layer = *layers_.back();
    std::vector<SurfaceRecord>& records = records_[id];
    if (standing) {
      layer.sources.reserve(quads);
      records.reserve(quads);
    }
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_QUAD);
    if (quads > 0) {
      // Embree pads the buffer: it reads vertices sixteen bytes at a time.
      auto* vertex = static_cast<Vec3*>(rtcSetNewGeometryBuffer(
          geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3), vertices));
      auto* quad = static_cast<std::array<std::uint32_t, 4>*>(
          rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 16, quads));
      std::uint32_t base = 0;
      for (const auto& [mesh, i] : parts) {
        const Eigen::Affine3f place =
            i < 0 ? Eigen::Affine3f::Identity()
                  : Eigen::Affine3f(instances[static_cast<std::size_t>(i)].world_from_model);
        const float scale = place.linear().col(0).norm();
        for (const Vec3& v : mesh->vertices) *vertex++ = i < 0 ? v : Vec3(place * v);
        for (std::uint32_t q = 0; q < mesh->quads.size(); ++q) {
          for (std::size_t k = 0; k < 4; ++k) (*quad)[k] = base + mesh->quads[q][k];
          ++quad;
          if (standing) {
            layer.sources.push_back({i, q});
            records.push_back(MakeRecord(world_.palette, *mesh, q,
                                         i < 0 ? nullptr : &instances[static_cast<std::size_t>(i)],
                                         i));
          }
          if (id != kCutout) continue;
          const Surface& surface = mesh->surfaces[q];
          const Texture& texture = pictures_[world_.palette[surface.material].picture];
          layer.cutouts.push_back(
              {&texture, surface.gu.norm() / scale * static_cast<float>(texture.size())});
        }
        base += static_cast<std::uint32_t>(mesh->vertices.size());
      }
    }
    if (id == kCutout) {
      rtcSetGeometryUserData(geometry, &layer);
      rtcSetGeometryIntersectFilterFunction(geometry, &Layer::Filter);
      rtcSetGeometryOccludedFilterFunction(geometry, &Layer::Filter);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, id);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(scene);
  return scene;
}

RTCGeometry Scene::Place(const Instance& placed) const {
  const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(geometry, models_.at(static_cast<std::size_t>(placed.model)));
  const Eigen::Matrix<float, 3, 4> matrix = placed.world_from_model.matrix().topRows<3>();
  rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, matrix.data());
  rtcCommitGeometry(geometry);
  return geometry;
}

const Mesh& Scene::MeshOf(const Instance* placed, bool solid) const {
  if (placed == nullptr) return solid ? world_.solid : world_.cutout;
  const Model& model = world_.models[static_cast<std::size_t>(placed->model)];
  return solid ? model.solid : model.cutout;
}

void Scene::Intersect(RTCRayHit16& rays, const int* valid, float spread, const Movers* movers,
                      SurfaceRecord* records) const {
  Context context(spread, kTogether);
  std::fill_n(rays.hit.geomID, kPacket, RTC_INVALID_GEOMETRY_ID);
  std::fill_n(rays.hit.instID[0], kPacket, RTC_INVALID_GEOMETRY_ID);
  rtcIntersect16(valid, scene_, &context.rtc, &rays);
  std::array<float, kPacket> still;
  std::copy_n(rays.ray.tfar, kPacket, still.begin());
  if (movers != nullptr && !movers->instances_.empty()) {
    Context apart(spread, kApart);
    rtcIntersect16(valid, movers->scene_, &apart.rtc, &rays);
  }
  static constexpr SurfaceRecord kNothing = [] {
    SurfaceRecord r{};
    r.flags = SurfaceRecord::kSky;
    return r;
  }();
  for (std::size_t i = 0; i < kPacket; ++i) {
    if (valid[i] == 0 || rays.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) {
      records[i] = kNothing;
      continue;
    }
    const unsigned id = rays.hit.geomID[i];
    const bool solid = id == kSolid;
    std::uint32_t quad = rays.hit.primID[i];
    const Instance* placed = nullptr;
    if (rays.ray.tfar[i] < still[i]) {
      const auto number = rays.hit.instID[0][i];
      placed = &movers->instances_[number];
      records[i] =
          MakeRecord(world_.palette, MeshOf(placed, solid), quad, placed, static_cast<int>(number));
    } else {
      records[i] = records_[id][quad];
      if ((records[i].flags & SurfaceRecord::kSmooth) == 0) continue;
      const Source& source = (solid ? solid_ : cutout_)->sources[quad];
      quad = source.quad;
      if (source.instance >= 0) {
        placed = &world_.instances[static_cast<std::size_t>(source.instance)];
      }
    }
    if ((records[i].flags & SurfaceRecord::kSmooth) != 0) {
      BendNormal(MeshOf(placed, solid), quad, rays.hit.u[i], rays.hit.v[i], placed, records[i]);
    }
  }
}

void Scene::Occluded(RTCRay16& rays, const int* valid, const Movers* movers) const {
  Context context(0, kTogether);
  rtcOccluded16(valid, scene_, &context.rtc, &rays);
  if (movers == nullptr || movers->instances_.empty()) return;
  std::array<int, kPacket> open;
  for (int i = 0; i < kPacket; ++i) {
    open[static_cast<std::size_t>(i)] = valid[i] != 0 && rays.tfar[i] >= 0 ? -1 : 0;
  }
  Context apart(0, kApart);
  rtcOccluded16(open.data(), movers->scene_, &apart.rtc, &rays);
}

Movers::Movers(const Scene& scene, const std::vector<Instance>& instances) : instances_(instances) {
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
