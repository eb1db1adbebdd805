#include "recollect/simulation/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "recollect/simulation/packet.h"

namespace recollect::simulation {
namespace {

constexpr std::int32_t kSunlit = 0x40000000;
constexpr float kShadowReach = 400;  // metres
constexpr int kBlock = 16;           // pixels, either way, whose outlines are refined together

class Frame {
 public:
  Frame(const Scene& scene, const PictureSet& pictures, const Sky& sky, float wetness,
        const View& view, const Movers* movers)
      : scene_(scene),
        textures_(pictures.view()),
        sky_(sky),
        wetness_(wetness),
        camera_(view.camera),
        movers_(movers),
        kernel_(*PacketKernels().front()),
        spread_(static_cast<float>(1 / view.camera.fx)) {
    for (int y = 0; y < camera_.height; ++y) {
      const SE3 pose = Interpolate(view.world_from_camera, view.world_from_camera_last,
                                   camera_.height > 1 ? y / (camera_.height - 1.0) : 0.0);
      const Eigen::Matrix3d R = pose.rotation();
      for (int i = 0; i < 9; ++i) poses_.push_back(static_cast<float>(R(i / 3, i % 3)));
      for (int i = 0; i < 3; ++i) poses_.push_back(static_cast<float>(pose.translation()[i]));
    }
    rows_ = {poses_.data(), static_cast<float>(camera_.fx), static_cast<float>(camera_.fy),
             static_cast<float>(camera_.cx), static_cast<float>(camera_.cy)};
    for (int k = 0; k < kPacket; ++k) {
      rays_.ray.mask[k] = shadows_.mask[k] = ~0U;
      sun_.x.at[k] = sky.light().to_sun[0];
      sun_.y.at[k] = sky.light().to_sun[1];
      sun_.z.at[k] = sky.light().to_sun[2];
      rays_.ray.id[k] = shadows_.id[k] = static_cast<unsigned>(k);
    }
  }

  Rendering Render() {
    Rendering out{camera_.width, camera_.height, {}, {}};
    const std::size_t pixels = out.Index(0, camera_.height);
    for (auto& plane : out.light) plane.resize(pixels);
    out.depth.resize(pixels);
    std::vector<std::int32_t> ids(pixels);
    std::array<Pixel, kPacket> tile;
    for (int y = 0; y < camera_.height; y += 4) {
      for (int x = 0; x < camera_.width; x += 4) {
        int count = 0;
        for (int k = 0; k < kPacket; ++k) {
          const int px = x + k % 4, py = y + k / 4;
          if (px >= camera_.width || py >= camera_.height) continue;
          tile[static_cast<std::size_t>(count++)] = {px, py, 0, 0};
        }
        Trace(tile.data(), count);
        for (int k = 0; k < count; ++k) {
          const auto& p = tile[static_cast<std::size_t>(k)];
          const std::size_t i = out.Index(p.x, p.y);
          out.light[0][i] = packet_.color.x.at[k];
          out.light[1][i] = packet_.color.y.at[k];
          out.light[2][i] = packet_.color.z.at[k];
          out.depth[i] = packet_.t.at[k] / packet_.length.at[k];
          ids[i] = packet_.id.at[k];
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

  // Fills the packet's colours, distances (0: sky) and ids for up to kPacket
  // rays.
  void Trace(const Pixel* pixels, int count) {
    Packet& p = packet_;
    alignas(64) std::array<int, kPacket> valid;
    for (int k = 0; k < kPacket; ++k) {
      const Pixel& pixel = pixels[std::min(k, count - 1)];
      p.image_x.at[k] = static_cast<float>(pixel.x) + pixel.dx;
      p.image_y.at[k] = static_cast<float>(pixel.y) + pixel.dy;
      p.row.at[k] = pixel.y;
      valid[static_cast<std::size_t>(k)] = k < count ? -1 : 0;
      rays_.ray.tnear[k] = 0.02F;
      rays_.ray.tfar[k] = std::numeric_limits<float>::infinity();
    }
    kernel_.aim(rows_, p);
    Copy(p.origin, p.direction, rays_.ray);
    scene_.Intersect(rays_, valid.data(), spread_, movers_, p.records);
    for (int k = 0; k < kPacket; ++k) {
      p.t.at[k] = (p.records[k].flags & SurfaceRecord::kSky) != 0 ? 0 : rays_.ray.tfar[k];
    }
    kernel_.surface(textures_, sky_.light(), wetness_, spread_, p);
    Shadows(count);
    kernel_.light(textures_, sky_.light(), p);
  }

  void Shadows(int count) {
    Packet& p = packet_;
    for (int k = 0; k < kPacket; ++k) p.sunlit.at[k] = p.facing_sun.at[k] > 0 ? 1.0F : 0.0F;
    if (!sky_.shadows()) return;
    alignas(64) std::array<int, kPacket> asked;
    int any = 0;
    for (int k = 0; k < kPacket; ++k) {
      const int ask = k < count && p.facing_sun.at[k] > 0 ? -1 : 0;
      asked[static_cast<std::size_t>(k)] = ask;
      any |= ask;
      shadows_.tnear[k] = p.lift.at[k];
      shadows_.tfar[k] = kShadowReach;
    }
    if (any == 0) return;
    Copy(p.shadow_origin, sun_, shadows_);
    scene_.Occluded(shadows_, asked.data(), movers_);
    for (int k = 0; k < count; ++k) {
      if (asked[static_cast<std::size_t>(k)] == 0) continue;
      if (shadows_.tfar[k] < 0) {
        p.sunlit.at[k] = 0;
      } else if ((p.flags.at[k] & SurfaceRecord::kFoliage) == 0) {
        p.id.at[k] += kSunlit;
      }
    }
  }

  static void Copy(const Lane3& from, const Lane3& to, RTCRay16& rays) {
    std::copy_n(from.x.at, kPacket, rays.org_x);
    std::copy_n(from.y.at, kPacket, rays.org_y);
    std::copy_n(from.z.at, kPacket, rays.org_z);
    std::copy_n(to.x.at, kPacket, rays.dir_x);
    std::copy_n(to.y.at, kPacket, rays.dir_y);
    std::copy_n(to.z.at, kPacket, rays.dir_z);
  }

  // Three rays instead of one where neighbours differ in object and in
  // brightness.
  void Refine(Rendering& out, const std::vector<std::int32_t>& ids) {
    const auto brightness = [&](std::size_t i) {
      return out.light[0][i] + out.light[1][i] + out.light[2][i];
    };
    const auto differ = [&](std::size_t a, std::size_t b) {
      if (ids[a] == ids[b]) return false;
      const float la = brightness(a), lb = brightness(b);
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
    int count = 0;
    const auto flush = [&] {
      Trace(queue.data(), count);
      for (int k = 0; k < count; k += kExtra) {
        const Pixel& pixel = queue[static_cast<std::size_t>(k)];
        const std::size_t i = out.Index(pixel.x, pixel.y);
        const Lane* colors[] = {&packet_.color.x, &packet_.color.y, &packet_.color.z};
        for (std::size_t c = 0; c < 3; ++c) {
          float& light = out.light[c][i];
          light = (light + colors[c]->at[k] + colors[c]->at[k + 1]) * (1 / 3.0F);
        }
      }
      count = 0;
    };
    // Pixels along a curve that fills one block after the other: rays of a
    // packet stay together.
    for (int by = 0; by < out.height; by += kBlock) {
      for (int bx = 0; bx < out.width; bx += kBlock) {
        for (int k = 0; k < kBlock * kBlock; ++k) {
          const int x = bx + EvenBits(k), y = by + EvenBits(k >> 1);
          if (x >= out.width || y >= out.height || rough[out.Index(x, y)] == 0) continue;
          for (const auto& offset : kOffsets) {
            queue[static_cast<std::size_t>(count++)] = {x, y, offset[0], offset[1]};
          }
          if (count + kExtra > kPacket) flush();
        }
      }
    }
    if (count > 0) flush();
  }

  // Every second of the low eight bits, together.
  static int EvenBits(int k) { return (k & 1) | ((k >> 1) & 2) | ((k >> 2) & 4) | ((k >> 3) & 8); }

  const Scene& scene_;
  TextureView textures_;
  const Sky& sky_;
  float wetness_;
  PinholeCamera camera_;
  const Movers* movers_;
  const PacketKernel& kernel_;
  float spread_;
  std::vector<float> poses_;
  CameraRows rows_;
  Packet packet_{};
  Lane3 sun_;  // the way to it, for each ray
  alignas(64) RTCRayHit16 rays_{};
  alignas(64) RTCRay16 shadows_{};
};

}  // namespace

Rendering Render(const Scene& scene, const PictureSet& pictures, const Sky& sky, float wetness,
                 const View& view, const Movers* movers) {
  return Frame(scene, pictures, sky, wetness, view, movers).Render();
}

}  // namespace recollect::simulation
