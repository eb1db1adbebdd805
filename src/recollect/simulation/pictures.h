#pragma once

#include <vector>

#include "recollect/core/parallel.h"
#include "recollect/simulation/material.h"
#include "recollect/simulation/packet.h"
#include "recollect/simulation/texture.h"

namespace recollect::simulation {

// All textures of the world, painted by formulas; the same in every world. About two seconds and
// 60 MB.
class PictureSet {
 public:
  explicit PictureSet(ThreadPool& pool);

  const Texture& operator[](Picture picture) const {
    return textures_[static_cast<std::size_t>(picture)];
  }
  // All of them for shading; the last is slow noise for variation over large surfaces.
  TextureView view() const {
    return {texels_.data(), starts_.data(), log_sizes_.data(), kPictures};
  }

 private:
  std::vector<Texture> textures_;
  std::vector<std::uint32_t> texels_;
  std::vector<std::int32_t> starts_, log_sizes_;
};

// Sheets of pictures hold this many columns and rows of equal cells.
constexpr int kWindowCells = 8;   // 8 x 8 views into windows
constexpr int kPosterCells = 4;   // 4 x 4 murals and posters
constexpr int kTrafficCells = 4;  // 4 x 4 traffic signs
constexpr int kSignColumns = 2, kSignRows = 16;

// The painters by family; each returns the texture of one picture of its family.
Texture PaintGround(Picture picture);
Texture PaintWall(Picture picture);
Texture PaintPlant(Picture picture);
Texture PaintSheet(Picture picture);

}  // namespace recollect::simulation
