#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace recollect::simulation {

// Linear RGB: reflectance (0..1) of a surface, or radiance of light.
using Color = Eigen::Array3f;

struct Texel {
  Color color = Color::Zero();
  float alpha = 1;
};

// A square picture that tiles the plane, with its mip levels: each half the size of the last, down
// to one texel. Texture coordinates count tiles: (0, 0)-(1, 1) is the whole picture, v upwards.
class Texture {
 public:
  // Fills size x size texels (size a power of two) with `paint(u, v)` at the texels' centres.
  static Texture Paint(int size, const std::function<Texel(float u, float v)>& paint);
  // Takes a picture, row by row from v = 0.
  Texture(int size, const std::vector<Texel>& texels);

  int size() const { return size_; }

  // The levels' texels as TextureView has them, level by level; the texture keeps none of them.
  std::vector<std::uint32_t> TakeTexels() { return std::move(texels_); }
  int levels() const { return levels_; }
  // Where level l begins among the texels.
  std::size_t start(int l) const { return starts_[static_cast<std::size_t>(l)]; }

  // Whether a cut-out texture is solid at (u, v), read at the given mip level (clamped).
  bool Solid(float u, float v, int level) const;

 private:
  int size_ = 0, levels_ = 0;
  std::vector<std::size_t> starts_, solid_starts_;  // where each level begins
  std::vector<std::uint32_t> texels_;
  std::vector<std::uint8_t> solid_;  // alpha alone, scaled to keep coverage in all levels
};

}  // namespace recollect::simulation
