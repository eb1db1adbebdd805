#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace recollect::simulation {

// Rays are traced and shaded sixteen at a time.
constexpr int kPacket = 16;

// One number of each ray of a packet.
struct alignas(64) Lane {
  float at[kPacket];
};
struct alignas(64) IntLane {
  std::int32_t at[kPacket];
};
struct Lane3 {
  Lane x, y, z;
};

// A quad as shading needs it, in world coordinates: u = gu . p + u0 in tiles of
// the picture.
struct SurfaceRecord {
  static constexpr std::int32_t kSky = 1, kFoliage = 2, kGround = 4,
                                kSmooth = 8;  // flags
  float normal[3], openness;
  float gu[3], u0;
  float gv[3], v0;
  float shading_normal[3], gloss;
  float tint[3], patchiness;
  std::int32_t picture, flags, id;
  float unused;
};
static_assert(sizeof(SurfaceRecord) == 96);

// A camera, ready to make rays. Each row of pixels has a pose of its own
// (rolling shutter): the rotation row by row, then the place.
struct CameraRows {
  static constexpr int kPose = 12;
  const float* poses;
  float fx, fy, cx, cy;
};

// Rays with unit directions, what they hit and what comes of it.
struct Packet {
  // Asked of the caller: where in the image, pixels, and the number of the row.
  Lane image_x, image_y;
  IntLane row;
  // Set by aim():
  Lane3 origin, direction;
  Lane length;  // of the direction's multiple with z = 1 in the camera
  // Asked of the caller: what was hit, t metres away (0: the sky).
  Lane t;
  SurfaceRecord records[kPacket];
  // Set by surface():
  Lane3 normal, albedo;
  Lane3 shadow_origin;  // lifted off the surface, by lift along the ray
  Lane lift;
  Lane gloss, openness, facing_sun;  // facing_sun > 0: worth a shadow ray
  IntLane flags, id;                 // id differs where an outline runs between two pixels
  // Asked of the caller: 1 in the sun, 0 in shadow.
  Lane sunlit;
  // Set by light(): linear radiance towards the origin.
  Lane3 color;
};

constexpr int kTextureLevels = 16;

// All textures: rows of texels from v = 0, each with its first texel once more
// at its end, levels with their first row at their end. Texels are square roots
// of R, G, B in the low bytes, then alpha. Level l of picture p begins at texel
// starts[p * kTextureLevels + l]; its size is 2^(log_sizes[p] - l).
struct TextureView {
  const std::uint32_t* texels;
  const std::int32_t* starts;
  const std::int32_t* log_sizes;
  std::int32_t variation;  // number of the slow noise
};

// The light of a day; see Sky.
struct SkyLight {
  float to_sun[3], side[3];  // side: horizontally towards the sun
  float sun[3], zenith[3], horizon[3], cloud_light[3], cloud_dark[3];
  float ambient_middle[3], ambient_slope[3], ambient_sunward[3];
  float cover, haze, drift_u, drift_v;
};

// A row of the film: planes of light in, B, G, R out.
struct FilmRow {
  const float* light[3];
  int width;
  float scale[3];
  float across, along,
      vignette;                  // of the image's half diagonal: one pixel, and the row's height
  float read_noise, shot_noise;  // squared
  const float* bells;            // 4096 samples of a normal distribution
  const std::int32_t* tone;      // 8-bit value of each of 4097 levels
  std::uint32_t seed;
  std::uint8_t* out;
};

// The inner loops for one instruction set. All of them give the same bits.
struct PacketKernel {
  std::string_view name;
  // Origins and directions of rays through the image.
  void (*aim)(const CameraRows& camera, Packet& packet);
  // Normal, colour and finish at the hits, seen by pixels `spread` metres wide
  // at one metre.
  void (*surface)(const TextureView& textures, const SkyLight& sky, float wetness, float spread,
                  Packet& packet);
  // Light from the hits, or from the sky, towards the rays' origin.
  void (*light)(const TextureView& textures, const SkyLight& sky, Packet& packet);
  void (*develop)(const FilmRow& row);
};

// Null where the compiler's target lacks the instructions.
const PacketKernel* PlainPackets();
const PacketKernel* Avx2Packets();
const PacketKernel* Avx512Packets();

// Those that this machine runs, the fastest first; the plain one is always
// among them.
std::span<const PacketKernel* const> PacketKernels();

}  // namespace recollect::simulation
