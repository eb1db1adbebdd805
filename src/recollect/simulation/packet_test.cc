// Pictures must not depend on the machine: every instruction set gives the same
// bits.
#include "recollect/simulation/packet.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "recollect/core/random.h"

namespace recollect::simulation {
namespace {

constexpr int kRows = 3;

// Two pictures of noise, 16 and 4 texels wide.
struct Pictures {
  std::vector<std::uint32_t> texels;
  std::vector<std::int32_t> starts = std::vector<std::int32_t>(2 * kTextureLevels);
  std::vector<std::int32_t> log_sizes = {4, 2};

  explicit Pictures(Random& random) {
    for (std::size_t p = 0; p < 2; ++p) {
      for (int l = 0; l <= log_sizes[p]; ++l) {
        starts[p * kTextureLevels + static_cast<std::size_t>(l)] =
            static_cast<std::int32_t>(texels.size());
        const int row = (1 << (log_sizes[p] - l)) + 1;
        for (int i = 0; i < row * row; ++i) {
          texels.push_back(static_cast<std::uint32_t>(random.Bits()));
        }
      }
    }
  }
  TextureView view() const { return {texels.data(), starts.data(), log_sizes.data(), 1}; }
};

float Draw(Random& random, double low, double high) {
  return static_cast<float>(random.Uniform(low, high));
}

void Unit(Random& random, float* v) {
  float length = 0;
  for (int k = 0; k < 3; ++k) {
    v[k] = Draw(random, -1, 1);
    length += v[k] * v[k];
  }
  for (int k = 0; k < 3; ++k) v[k] /= std::sqrt(length);
}

Packet RandomPacket(Random& random) {
  Packet p{};
  for (int i = 0; i < kPacket; ++i) {
    p.image_x.at[i] = Draw(random, 0, 640);
    p.image_y.at[i] = Draw(random, 0, 480);
    p.row.at[i] = static_cast<std::int32_t>(random.Index(kRows));
    p.sunlit.at[i] = random.Uniform() < 0.5 ? 1.0F : 0.0F;
    SurfaceRecord& r = p.records[i];
    if (random.Uniform() < 0.2) {
      r.flags = SurfaceRecord::kSky;
      continue;
    }
    p.t.at[i] = Draw(random, 0.5, 300);
    Unit(random, r.normal);
    Unit(random, r.shading_normal);
    for (int k = 0; k < 3; ++k) {
      r.gu[k] = Draw(random, -0.5, 0.5);
      r.gv[k] = Draw(random, -0.5, 0.5);
      r.tint[k] = Draw(random, 0, 1);
    }
    r.u0 = Draw(random, -3, 3);
    r.openness = Draw(random, 0, 1);
    r.gloss = random.Uniform() < 0.5 ? Draw(random, 0, 1) : 0.0F;
    r.patchiness = random.Uniform() < 0.5 ? Draw(random, 0, 1) : 0.0F;
    r.flags = static_cast<std::int32_t>(2 * random.Index(4));
    r.picture = static_cast<std::int32_t>(random.Index(2));
    r.id = i;
  }
  return p;
}

SkyLight RandomSky(Random& random) {
  SkyLight sky{};
  Unit(random, sky.to_sun);
  Unit(random, sky.side);
  for (float* color : {sky.sun, sky.zenith, sky.horizon, sky.cloud_light, sky.cloud_dark,
                       sky.ambient_middle, sky.ambient_slope, sky.ambient_sunward}) {
    for (int k = 0; k < 3; ++k) color[k] = Draw(random, 0.1, 3);
  }
  sky.cover = Draw(random, 0, 1);
  sky.haze = 1e-3F;
  return sky;
}

TEST(Packet, AllInstructionSetsShadeAlike) {
  Random random(7);
  const Pictures pictures(random);
  ASSERT_FALSE(PacketKernels().empty());
  const PacketKernel& plain = *PacketKernels().back();
  for (int trial = 0; trial < 200; ++trial) {
    const SkyLight sky = RandomSky(random);
    const Packet packet = RandomPacket(random);
    std::vector<float> poses;
    for (int row = 0; row < kRows; ++row) {
      for (int k = 0; k < 3; ++k) {  // no rotations, but units will do
        poses.resize(poses.size() + 3);
        Unit(random, &poses[poses.size() - 3]);
      }
      for (int k = 0; k < 3; ++k) poses.push_back(Draw(random, -900, 900));
    }
    const float wetness = trial % 2 == 0 ? 0.0F : 0.8F;
    const auto shade = [&](const PacketKernel& kernel) {
      Packet p = packet;
      kernel.aim({poses.data(), 489, 489, 320, 240}, p);
      kernel.surface(pictures.view(), sky, wetness, 0.002F, p);
      kernel.light(pictures.view(), sky, p);
      return p;
    };
    const Packet expected = shade(plain);
    for (int i = 0; i < kPacket; ++i) {
      ASSERT_TRUE(std::isfinite(expected.color.x.at[i]));
    }
    for (const PacketKernel* kernel : PacketKernels()) {
      const Packet found = shade(*kernel);
      ASSERT_EQ(std::memcmp(&found, &expected, sizeof found), 0) << kernel->name;
    }
  }
}

TEST(Packet, AllInstructionSetsDevelopAlike) {
  Random random(8);
  constexpr int kWidth = 45;  // no whole number of lanes
  std::vector<float> planes(3 * kWidth), bells(4096);
  std::vector<std::int32_t> tone(4097);
  for (float& x : planes) x = Draw(random, 0, 1.5);
  for (float& x : bells) x = static_cast<float>(random.Normal());
  for (std::size_t i = 0; i < tone.size(); ++i) tone[i] = static_cast<std::int32_t>(i / 17);
  const auto develop = [&](const PacketKernel& kernel, std::uint32_t seed) {
    std::vector<std::uint8_t> out(3 * kWidth);
    kernel.develop({{planes.data(), planes.data() + kWidth, planes.data() + 2 * kWidth},
                    kWidth,
                    {1, 0.9F, 1.1F},
                    0.01F,
                    0.3F,
                    0.25F,
                    1e-5F,
                    1e-4F,
                    bells.data(),
                    tone.data(),
                    seed,
                    out.data()});
    return out;
  };
  const auto expected = develop(*PacketKernels().back(), 5);
  for (const PacketKernel* kernel : PacketKernels()) {
    EXPECT_EQ(develop(*kernel, 5), expected) << kernel->name;
    EXPECT_NE(develop(*kernel, 6), expected) << kernel->name;  // another grain
  }
}

}  // namespace
}  // namespace recollect::simulation
