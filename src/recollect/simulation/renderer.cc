#include "recollect/simulation/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "recollect/simulation/shading.h"

namespace recollect::simulation {
namespace {

// A camera's pose when one row was taken, ready to make rays.
struct RowPose {
  Eigen::Matrix3f R;
  Vec3 t;
};

// What one sample of a pixel found.
struct Sample {
  Color color;
  float depth;
  std::uint32_t id;
};

constexpr std::uint32_t kSunlit = 0x40000000;

class Frame {
 public:
  Frame(const Scene& scene, const PictureSet& pictures, const Sky& sky, float wetness,
        const View& view, const Movers* movers)
      : scene_(scene),
        pictures_(pictures),
        sky_(sky),
        wetness_(wetness),
        camera_(view.camera),
        movers_(movers),
        spread_(static_cast<float>(1 / view.camera.fx)) {
    for (int y = 0; y < camera_.height; ++y) {
      const SE3 pose = Interpolate(view.world_from_camera, view.world_from_camera_last,
                                   camera_.height > 1 ? y / (camera_.height - 1.0) : 0.0);
      rows_.push_back({pose.rotation().cast<float>(), pose.translation().cast<float>()});
    }
  }

  Rendering Render() {
    Rendering out{camera_.width, camera_.height, {}, {}};
    const std::size_t pixels = out.Index(0, camera_.height);
    out.radiance.resize(pixels);
    out.depth.resize(pixels);
    std::vector<std::uint32_t> ids(pixels);
    std::array<Pixel, kPacket> tile;
    std::array<Sample, kPacket> samples;
    for (int y = 0; y < camera_.height; y += 4) {
      for (int x = 0; x < camera_.width; x += 4) {
        int count = 0;
        for (int k = 0; k < kPacket; ++k) {
          const int px = x + k % 4, py = y + k / 4;
          if (px >= camera_.width || py >= camera_.height) continue;
          tile[static_cast<std::size_t>(count++)] = {px, py, 0, 0};
        }
        Trace(tile.data(), count, samples.data());
        for (int k = 0; k < count; ++k) {
          const auto& p = tile[static_cast<std::size_t>(k)];
          const auto& s = samples[static_cast<std::size_t>(k)];
          const std::size_t i = out.Index(p.x, p.y);
          out.radiance[i] = s.color;
          out.depth[i] = s.depth;
          ids[i] = s.id;
        }
      }
    }
    Refine(out, ids);
    return out;
  }

 private:
  struct Pixel {
    int x, y;
    float dx, dy;  // of the ray from the pixel's centre, pixels
  };

  // Colour, depth and id seen by up to kPacket rays.
  void Trace(const Pixel* pixels, int count, Sample* samples) const {
    alignas(64) RTCRayHit16 rays{};
    alignas(64) std::array<int, kPacket> valid{};
    std::array<Vec3, kPacket> directions;
    std::array<float, kPacket> lengths;  // of direction vectors with z = 1 in the camera
    for (int k = 0; k < count; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const RowPose& row = rows_[static_cast<std::size_t>(pixels[k].y)];
      const Vec3 in_camera((static_cast<float>(pixels[k].x - camera_.cx) + pixels[k].dx) * spread_,
                           static_cast<float>((static_cast<double>(pixels[k].y) - camera_.cy +
                                               static_cast<double>(pixels[k].dy)) /
                                              camera_.fy),
                           1);
      lengths[i] = in_camera.norm();
      directions[i] = row.R * (in_camera / lengths[i]);
      valid[i] = -1;
      Aim(rays.ray, k, row.t, directions[i], 0.02F, std::numeric_limits<float>::infinity());
    }
    std::array<Hit, kPacket> hits;
    scene_.Intersect(rays, valid.data(), spread_, movers_, hits.data());

    std::array<Shaded, kPacket> shaded;
    alignas(64) RTCRay16 shadows = rays.ray;  // lanes without a ray hold numbers, not NaNs
    alignas(64) std::array<int, kPacket> lit{};
    const bool sunny = sky_.sun().maxCoeff() > 1e-3F;
    bool any = false;
    for (int k = 0; k < count; ++k) {
      const auto i = static_cast<std::size_t>(k);
      if (hits[i].mesh == nullptr) continue;
      const RowPose& row = rows_[static_cast<std::size_t>(pixels[k].y)];
      const float t = rays.ray.tfar[k];
      const Vec3 point = row.t + directions[i] * t;
      shaded[i] = Surfaced(scene_, pictures_, wetness_, hits[i],
                           hits[i].moving ? movers_->instances() : scene_.instances(), point,
                           directions[i], t, spread_);
      if (sunny && (shaded[i].foliage || shaded[i].normal.dot(sky_.to_sun()) > 0)) {
        lit[i] = -1;
        any = true;
        const float lift = 2e-3F + 2e-4F * t;
        Aim(shadows, k, point - directions[i] * lift, sky_.to_sun(), lift, 400);
      }
    }
    if (any) scene_.Occluded(shadows, lit.data(), movers_);
    for (int k = 0; k < count; ++k) {
      const auto i = static_cast<std::size_t>(k);
      if (hits[i].mesh == nullptr) {
        samples[k] = {sky_.Radiance(directions[i]), 0, 0};
        continue;
      }
      const float t = rays.ray.tfar[k];
      const float sunlit = lit[i] != 0 && shadows.tfar[k] > 0 ? 1.0F : 0.0F;
      samples[k] = {Lit(sky_, shaded[i], directions[i], t, sunlit), t / lengths[i],
                    shaded[i].id + 1 + (sunlit > 0 && !shaded[i].foliage ? kSunlit : 0U)};
    }
  }

  template <typename Rays>
  static void Aim(Rays& rays, int k, const Vec3& from, const Vec3& to, float near, float far) {
    rays.org_x[k] = from.x();
    rays.org_y[k] = from.y();
    rays.org_z[k] = from.z();
    rays.dir_x[k] = to.x();
    rays.dir_y[k] = to.y();
    rays.dir_z[k] = to.z();
    rays.tnear[k] = near;
    rays.tfar[k] = far;
    rays.time[k] = 0;
    rays.mask[k] = ~0U;
    rays.id[k] = static_cast<unsigned>(k);
    rays.flags[k] = 0;
  }

  // Three rays instead of one where neighbours differ in object and in brightness.
  void Refine(Rendering& out, const std::vector<std::uint32_t>& ids) const {
    const auto differ = [&](std::size_t a, std::size_t b) {
      if (ids[a] == ids[b]) return false;
      const float la = out.radiance[a].sum(), lb = out.radiance[b].sum();
      return std::abs(la - lb) > 0.25F * std::max(la, lb);
    };
    std::vector<char> rough(ids.size(), 0);
    for (int y = 0; y < out.height; ++y) {
      for (int x = 0; x < out.width; ++x) {
        const std::size_t i = out.Index(x, y);
        if (x + 1 < out.width && differ(i, i + 1)) rough[i] = rough[i + 1] = 1;
        if (y + 1 < out.height && differ(i, out.Index(x, y + 1))) {
          rough[i] = rough[out.Index(x, y + 1)] = 1;
        }
      }
    }
    constexpr int kExtra = 2;
    constexpr std::array<std::array<float, 2>, kExtra> kOffsets = {
        {{-0.33F, -0.25F}, {0.25F, 0.33F}}};
    std::array<Pixel, kPacket> queue;
    std::array<Sample, kPacket> samples;
    int count = 0;
    const auto flush = [&] {
      Trace(queue.data(), count, samples.data());
      for (int k = 0; k < count; k += kExtra) {
        const auto q = static_cast<std::size_t>(k);
        Color& pixel = out.radiance[out.Index(queue[q].x, queue[q].y)];
        pixel = (pixel + samples[q].color + samples[q + 1].color) * (1 / 3.0F);
      }
      count = 0;
    };
    for (int y = 0; y < out.height; ++y) {
      for (int x = 0; x < out.width; ++x) {
        if (rough[out.Index(x, y)] == 0) continue;
        for (const auto& offset : kOffsets) {
          queue[static_cast<std::size_t>(count++)] = {x, y, offset[0], offset[1]};
        }
        if (count + kExtra > kPacket) flush();
      }
    }
    if (count > 0) flush();
  }

  const Scene& scene_;
  const PictureSet& pictures_;
  const Sky& sky_;
  float wetness_;
  PinholeCamera camera_;
  const Movers* movers_;
  float spread_;
  std::vector<RowPose> rows_;
};

}  // namespace

Rendering Render(const Scene& scene, const PictureSet& pictures, const Sky& sky, float wetness,
                 const View& view, const Movers* movers) {
  return Frame(scene, pictures, sky, wetness, view, movers).Render();
}

}  // namespace recollect::simulation
