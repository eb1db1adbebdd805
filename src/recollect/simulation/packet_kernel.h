// The inner loops of PacketKernel, compiled once for each instruction set by
// files that define RECOLLECT_LANES, RECOLLECT_KERNEL and
// RECOLLECT_KERNEL_NAME. Nothing here has a name outside its file but the
// kernel: the linker could not tell the variants of a shared inline function
// apart.
#include "recollect/simulation/packet_lanes.h"

namespace recollect::simulation {
namespace {

// Bytes interpolated at (u, v) of levels of `log_size` that begin at texel
// `start`.
INLINE Vec Bilinear(const TextureView& textures, Ints start, Ints log_size, Floats u, Floats v) {
  const Floats scale = FromBits((log_size + 127) << 23);
  const Floats x = u * scale - 0.5F, y = v * scale - 0.5F;
  const Ints fx = Floor(x), fy = Floor(y);
  const Floats a = x - Real(fx), b = y - Real(fy);
  const Ints mask = Truncate(scale) - 1, row = mask + 2;
  const Ints at = start + (fy & mask) * row + (fx & mask);
  const auto* texels = reinterpret_cast<const std::int32_t*>(textures.texels);
  const Ints t00 = Gather(texels, at), t10 = Gather(texels, at + 1);
  const Ints t01 = Gather(texels, at + row), t11 = Gather(texels, at + row + 1);
  Floats c[3];
  for (int i = 0; i < 3; ++i) {
    const Floats c00 = Real((t00 >> (8 * i)) & 255), c10 = Real((t10 >> (8 * i)) & 255);
    const Floats c01 = Real((t01 >> (8 * i)) & 255), c11 = Real((t11 >> (8 * i)) & 255);
    const Floats low = c00 + (c10 - c00) * a, high = c01 + (c11 - c01) * a;
    c[i] = low + (high - low) * b;
  }
  return {c[0], c[1], c[2]};
}

INLINE Ints LevelStart(const TextureView& textures, Ints picture, Ints level) {
  return Gather(textures.starts, picture * kTextureLevels + level);
}

// Colour averaged over a parallelogram-like footprint about (u, v): `minor`
// tiles wide across and (du, dv) tiles long along its major axis. Mixes mip
// levels, with up to three taps along the axis.
INLINE Vec Sample(const TextureView& textures, Ints picture, Floats u, Floats v, Floats minor,
                  Floats du, Floats dv) {
  const Ints log_size = Gather(textures.log_sizes, picture);
  const Floats major = Sqrt(du * du + dv * dv);
  const Floats width = Max(minor, major * 0.25F);
  const Floats size = FromBits((log_size + 127) << 23);
  const Floats lod = FastLog2(Max(width * size, All(1)));
  const Ints level = Max(Min(Truncate(lod), log_size), Ints{});
  // Two levels are mixed about half-way between them only: either alone does
  // elsewhere.
  const Floats blend = (lod - Real(level)) * 2 - 0.5F;
  const Ints near = Min(blend >= 1 ? level + 1 : level, log_size);
  const Ints both = (blend > 0) & (blend < 1) & (level < log_size);
  const Floats mix = both ? blend : Floats{};
  const Ints next = Min(near + 1, log_size);
  const Ints start = LevelStart(textures, picture, near);
  const Ints next_start = LevelStart(textures, picture, next);
  const bool any_both = Any(both);
  const Ints taps = Max(Min(Truncate(0.75F * major / width + 0.5F), AllInts(3)), AllInts(1));
  const Floats step = 1 / Real(taps);
  Vec sum{};
  for (int i = 0; i < 3; ++i) {
    const Ints used = taps > i;
    if (i > 0 && !Any(used)) break;
    const Floats s = (static_cast<float>(i) + 0.5F) * step - 0.5F;
    const Floats tu = u + s * du, tv = v + s * dv;
    Vec c = Bilinear(textures, start, log_size - near, tu, tv);
    if (any_both) {
      c = c + (Bilinear(textures, next_start, log_size - next, tu, tv) - c) * mix;
    }
    sum = sum + c * c * (used ? step : Floats{});
  }
  return sum * All(1.0F / (255.0F * 255.0F));
}

// Slow noise averaged over about `width` tiles, from one mip level.
INLINE Vec Smooth(const TextureView& textures, Floats u, Floats v, Floats width) {
  const Ints log_size = AllInts(textures.log_sizes[textures.variation]);
  const Floats size = FromBits((log_size + 127) << 23);
  const Floats lod = FastLog2(Max(width * size, All(1))) + 0.5F;
  const Ints level = Max(Min(Truncate(lod), log_size), Ints{});
  const Vec c = Bilinear(textures, LevelStart(textures, AllInts(textures.variation), level),
                         log_size - level, u, v);
  return c * c * All(1.0F / (255.0F * 255.0F));
}

// One field of the records of lanes k, k + 1, ...
INLINE Ints Field(const Packet& p, int k, int word) {
  Ints index;
  for (int i = 0; i < kLanes; ++i) {
    index[i] = i * static_cast<int>(sizeof(SurfaceRecord) / sizeof(std::int32_t));
  }
  return Gather(reinterpret_cast<const std::int32_t*>(&p.records[k]) + word, index);
}
INLINE Vec Field3(const Packet& p, int k, int word) {
  return {FromBits(Field(p, k, word)), FromBits(Field(p, k, word + 1)),
          FromBits(Field(p, k, word + 2))};
}

// Which quarter of [-1, 1] a normal's component lies in, roughly.
INLINE Ints Quarter(Floats x) { return Truncate(x * 1.5F + 2); }

void Aim(const CameraRows& camera, Packet& p) {
  for (int k = 0; k < kPacket; k += kLanes) {
    const Floats x = (Load(p.image_x.at + k) - camera.cx) / camera.fx;
    const Floats y = (Load(p.image_y.at + k) - camera.cy) / camera.fy;
    const Floats length = Sqrt(x * x + y * y + 1);
    const Ints at = LoadInts(p.row.at + k) * CameraRows::kPose;
    Floats turned[3], place[3];
    for (int i = 0; i < 3; ++i) {
      turned[i] = (Gather(camera.poses + 3 * i, at) * x + Gather(camera.poses + 3 * i + 1, at) * y +
                   Gather(camera.poses + 3 * i + 2, at)) /
                  length;
      place[i] = Gather(camera.poses + 9 + i, at);
    }
    Store(p.direction, k, {turned[0], turned[1], turned[2]});
    Store(p.origin, k, {place[0], place[1], place[2]});
    Store(p.length.at + k, length);
  }
}

void Surface(const TextureView& textures, const SkyLight& sky, float wetness, float spread,
             Packet& p) {
  for (int k = 0; k < kPacket; k += kLanes) {
    const Vec d = Load(p.direction, k);
    const Floats t = Load(p.t.at + k);
    const Vec point = Load(p.origin, k) + d * t;
    const Vec flat = Field3(p, k, 0), gu = Field3(p, k, 4), gv = Field3(p, k, 8);
    const Floats openness = FromBits(Field(p, k, 3));
    const Ints flags = Field(p, k, 21);
    const Ints foliage = (flags & SurfaceRecord::kFoliage) != 0;
    Vec normal = Field3(p, k, 12);
    const Ints turn = (Dot(normal, d) > 0) & ~foliage;
    normal = normal * (turn ? All(-1) : All(1));

    // The pixel's footprint: `width` across, longer by the slant along the line
    // of sight.
    const Floats width = t * spread;
    const Floats cosine = Dot(flat, d);
    const Floats slant = Max(All(0.06F), Abs(cosine));
    const Vec side = Cross(d, flat), run = d - flat * cosine;
    const Vec across = side * (width / Max(Sqrt(Dot(side, side)), All(1e-12F)));
    const Vec along = run * (width / slant / Max(Sqrt(Dot(run, run)), All(1e-6F)));
    const Floats minor_u = Dot(gu, across), minor_v = Dot(gv, across);
    const Floats minor = Sqrt(minor_u * minor_u + minor_v * minor_v);
    const Floats u = Dot(gu, point) + FromBits(Field(p, k, 7));
    const Floats v = Dot(gv, point) + FromBits(Field(p, k, 11));
    Vec albedo = Field3(p, k, 16) *
                 Sample(textures, Field(p, k, 20), u, v, minor, Dot(gu, along), Dot(gv, along));

    // Slow variation over metres and tens of metres, about 1.
    const Floats patchiness = FromBits(Field(p, k, 19));
    if (Any(patchiness > 0)) {
      const Floats x = point.x + 0.6F * point.z, y = point.y - 0.8F * point.z;
      const Floats w = width / slant;
      const Floats broad = Smooth(textures, x / 61, y / 61, w / 61).x;
      const Floats fine = Smooth(textures, x / 11.3F, y / 11.3F, w / 11.3F).y;
      albedo = albedo * (1 + patchiness * (0.7F * broad + 0.6F * fine - 0.65F));
    }
    Floats gloss = FromBits(Field(p, k, 15));
    const Ints wet = (flags & SurfaceRecord::kGround) != 0;
    if (wetness > 0 && Any(wet)) {
      const Floats noise = Smooth(textures, point.x / 19, point.y / 19, width / 19).x;
      const Floats puddle = SmoothStep(All(0.45F), All(0.6F), noise);
      albedo = albedo * (wet ? All(1 - wetness * 0.45F) : All(1));
      gloss = wet ? Max(gloss, wetness * (0.25F + 0.75F * puddle)) : gloss;
    }
    const Ints facets = Quarter(normal.x) * 16 + Quarter(normal.y) * 4 + Quarter(normal.z);
    const Ints seen = (flags & SurfaceRecord::kSky) == 0;
    const Floats facing = foliage ? All(1) : Dot(normal, All(sky.to_sun));
    const Floats lift = 2e-3F + 2e-4F * t;
    Store(p.shadow_origin, k, point - d * lift);
    Store(p.lift.at + k, lift);
    Store(p.normal, k, normal);
    Store(p.albedo, k, albedo);
    Store(p.gloss.at + k, gloss);
    Store(p.openness.at + k, openness);
    Store(p.facing_sun.at + k, seen ? facing : Floats{});
    Store(p.flags.at + k, flags);
    Store(p.id.at + k, seen ? Field(p, k, 22) + (foliage ? Ints{} : facets) : Ints{});
  }
}

// Radiance of the sky from direction `d`, clouds included; below the horizon
// that of the haze.
INLINE Vec Radiance(const TextureView& textures, const SkyLight& sky, const Vec& d) {
  const Floats z = Max(d.z, Floats{});
  const Floats low = (1 - z) * (1 - z);
  const Vec sun = All(sky.sun);
  Vec color = Mix(All(sky.horizon), All(sky.zenith), 1 - low * low);
  const Floats toward = Max(Floats{}, Dot(d, All(sky.to_sun)));
  const Floats toward2 = toward * toward, toward4 = toward2 * toward2;
  const Floats toward16 = toward4 * toward4 * toward4 * toward4;
  color = color + sun * (0.04F * toward4 + 0.12F * toward16 * toward16 * toward16);
  const Ints above = z > 0.01F;
  if (sky.cover > 0.02F && Any(above)) {
    const Floats reach = 0.11F / (z + 0.12F);
    const Floats u = d.x * reach + sky.drift_u, v = d.y * reach + sky.drift_v;
    const Floats big = Smooth(textures, u, v, All(0.003F)).x;
    const Floats small = Smooth(textures, u * 4.3F, v * 4.3F, All(0.004F)).y;
    const Floats density = 0.68F * big + 0.32F * small;
    const float edge = 1 - sky.cover;
    const Floats alpha = SmoothStep(All(edge - 0.08F), All(edge + 0.22F), density) *
                         SmoothStep(All(0.01F), All(0.1F), z);
    const Floats thick = SmoothStep(All(edge + 0.05F), All(edge + 0.5F), density);
    color =
        Mix(color, Mix(All(sky.cloud_light), All(sky.cloud_dark), thick), above ? alpha : Floats{});
  }
  return color + sun * (toward > 0.99998F ? All(60) : Floats{});
}

// What a mirror would show: sky, or a skyline of trees and roofs that nobody
// can tell from the true one in a window pane.
INLINE Vec Reflection(const TextureView& textures, const SkyLight& sky, const Vec& d) {
  const Floats ridge = 0.10F + 0.12F * FastSin(d.x * 9 + 2 * d.y) * FastSin(d.y * 7 + 1);
  const Vec dim = (All(sky.ambient_middle) + All(sky.sun) * All(0.08F)) *
                  Vec{All(0.16F), All(0.2F), All(0.13F)};
  return Mix(dim, Radiance(textures, sky, d), SmoothStep(ridge - 0.02F, ridge + 0.03F, d.z));
}

void Light(const TextureView& textures, const SkyLight& sky, Packet& p) {
  const Vec sun = All(sky.sun), to_sun = All(sky.to_sun);
  for (int k = 0; k < kPacket; k += kLanes) {
    const Vec d = Load(p.direction, k);
    const Ints flags = LoadInts(p.flags.at + k);
    const Ints open = (flags & SurfaceRecord::kSky) != 0;
    Vec color{};
    if (Any(~open)) {
      const Vec normal = Load(p.normal, k);
      const Floats sunlit = Load(p.sunlit.at + k), openness = Load(p.openness.at + k);
      const Floats toward = Max(Floats{}, Dot(normal, to_sun));
      const Vec ambient = All(sky.ambient_middle) + All(sky.ambient_slope) * normal.z +
                          All(sky.ambient_sunward) * Max(Floats{}, Dot(normal, All(sky.side)));
      // Leaves scatter: lit from in front and, greener, from behind.
      const Floats leafy = (0.25F + 0.75F * toward) * (0.45F + 0.55F * openness);
      const Floats direct = sunlit * ((flags & SurfaceRecord::kFoliage) != 0 ? leafy : toward);
      color = Load(p.albedo, k) * (ambient * openness + sun * direct);
      const Floats gloss = Load(p.gloss.at + k);
      if (Any((gloss > 0) & ~open)) {
        const Floats along = Dot(normal, d);
        const Floats away = 1 - Min(All(1), Abs(along));
        const Floats away2 = away * away;
        const Floats share = gloss * (0.05F + 0.9F * away2 * away2 * away);
        const Vec mirrored = d - normal * (2 * along);
        color = Mix(color, Reflection(textures, sky, mirrored), share);
        // The sun's glint: its cosine to the 180th.
        Floats power = Dot(mirrored, to_sun), glint = All(1);
        power = power > 0.9F ? power : Floats{};
        for (int bit = 0; bit < 8; ++bit) {
          if ((180 >> bit) & 1) glint = glint * power;
          power = power * power;
        }
        color = color + sun * (gloss * sunlit * 1.5F * glint);
      }
      const Floats clear = FastExp(Load(p.t.at + k) * -sky.haze);
      const Floats sunward = Max(Floats{}, Dot(d, to_sun));
      const Floats sunward2 = sunward * sunward;
      const Vec haze = All(sky.horizon) * All(0.9F) + sun * (0.05F * sunward2 * sunward2);
      color = Mix(haze, color, clear);
    }
    if (Any(open)) color = Choose(open, Radiance(textures, sky, d), color);
    Store(p.color, k, color);
  }
}

// A number's bits well mixed (a multiply-xorshift hash).
INLINE Words Hash(Words h) {
  h = (h ^ (h >> 16)) * 0x7feb352dU;
  h = (h ^ (h >> 15)) * 0x846ca68bU;
  return h ^ (h >> 16);
}

void DevelopRow(const FilmRow& row) {
  Floats ramp;
  Words count;
  for (int i = 0; i < kLanes; ++i) {
    ramp[i] = static_cast<float>(i);
    count[i] = static_cast<std::uint32_t>(i);
  }
  for (int x = 0; x < row.width; x += kLanes) {
    const int n = row.width - x < kLanes ? row.width - x : kLanes;
    const Floats across =
        (ramp + static_cast<float>(x) - static_cast<float>(row.width) / 2) * row.across;
    const Floats shade = 1 - row.vignette * (across * across + row.along * row.along);
    const Words grain = Hash(count + (row.seed + static_cast<std::uint32_t>(x)));
    const Words picks[3] = {grain & 4095U, (grain >> 12) & 4095U,
                            ((grain * 0x9e3779b9U) >> 20) & 4095U};
    std::int32_t levels[3][kLanes];
    for (int c = 0; c < 3; ++c) {
      Floats light{};
      if (n == kLanes) {
        light = Load(row.light[c] + x);
      } else {
        for (int i = 0; i < n; ++i) light[i] = row.light[c][x + i];
      }
      light = light * row.scale[c] * shade;
      // Highlights bend over softly to white; then photons and electronics add
      // their noise.
      const Floats v = Min(All(1), light * 1.2F / (1 + 0.35F * light));
      const Floats deviation = Sqrt(row.read_noise + row.shot_noise * v);
      const Floats noisy = v + Gather(row.bells, reinterpret_cast<Ints>(picks[c])) * deviation;
      Store(levels[c], Gather(row.tone, Truncate(Clamp01(noisy) * 4096)));
    }
    for (int i = 0; i < n; ++i) {
      for (int c = 0; c < 3; ++c) {
        row.out[3 * (x + i) + c] = static_cast<std::uint8_t>(levels[2 - c][i]);
      }
    }
  }
}

}  // namespace

const PacketKernel* RECOLLECT_KERNEL() {
  static constexpr PacketKernel kKernel{RECOLLECT_KERNEL_NAME, &Aim, &Surface, &Light, &DevelopRow};
  return &kKernel;
}

}  // namespace recollect::simulation
