#include "recollect/simulation/pictures.h"

#include <optional>

#include "recollect/simulation/noise.h"

namespace recollect::simulation {
namespace {

Texture PaintVariation() {
  return Texture::Paint(256, [](float u, float v) {
    const float a = Fbm(u * 8, v * 8, 8, 6, 911, 0.6F);
    const float b = Fbm(u * 5, v * 5, 5, 5, 913, 0.6F);
    return Texel{{SmoothStep(0.2F, 0.8F, a), SmoothStep(0.2F, 0.8F, b), a * b}, 1};
  });
}

Texture PaintPicture(int index) {
  if (index == kPictures) return PaintVariation();
  const auto picture = static_cast<Picture>(index);
  if (picture == Picture::kPlain) {
    return Texture::Paint(1, [](float, float) { return Texel{Color::Ones(), 1}; });
  }
  switch (picture) {
    case Picture::kWindows:
    case Picture::kSigns:
    case Picture::kPosters:
    case Picture::kTrafficSigns:
      return PaintSheet(picture);
    case Picture::kBroadLeaves:
    case Picture::kFineLeaves:
    case Picture::kPalmFrond:
    case Picture::kLongLeaves:
    case Picture::kBlossom:
    case Picture::kHedge:
    case Picture::kGrassTuft:
    case Picture::kWireMesh:
    case Picture::kForest:
    case Picture::kBark:
      return PaintPlant(picture);
    case Picture::kAsphalt:
    case Picture::kSlabs:
    case Picture::kPavers:
    case Picture::kGrass:
    case Picture::kEarth:
    case Picture::kGravel:
    case Picture::kRoadPaint:
      return PaintGround(picture);
    default:
      return PaintWall(picture);
  }
}

}  // namespace

PictureSet::PictureSet(ThreadPool& pool) {
  std::vector<std::optional<Texture>> painted(kPictures + 1);
  pool.For(kPictures + 1, 1, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      painted[static_cast<std::size_t>(i)] = PaintPicture(static_cast<int>(i));
    }
  });
  starts_.resize((kPictures + 1) * kTextureLevels);
  for (std::size_t i = 0; i < painted.size(); ++i) {
    Texture& texture = textures_.emplace_back(std::move(*painted[i]));
    const std::vector<std::uint32_t> texels = texture.TakeTexels();
    for (int level = 0; level < texture.levels(); ++level) {
      starts_[i * kTextureLevels + static_cast<std::size_t>(level)] =
          static_cast<std::int32_t>(texels_.size() + texture.start(level));
    }
    log_sizes_.push_back(texture.levels() - 1);
    texels_.insert(texels_.end(), texels.begin(), texels.end());
  }
}

}  // namespace recollect::simulation
