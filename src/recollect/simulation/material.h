#pragma once

#include <cstddef>
#include <vector>

#include "recollect/simulation/texture.h"

namespace recollect::simulation {

// The pictures that materials show. kTextureKinds counts them.
enum class Picture : int {
  kPlain,
  kAsphalt,
  kSlabs,
  kPavers,
  kConcrete,
  kBoardConcrete,
  kGrass,
  kEarth,
  kGravel,
  kBrick,
  kPlaster,
  kTiles,
  kStone,
  kRoofTiles,
  kMetal,
  kWood,
  kBark,
  kRoadPaint,
  kWindows,
  kSigns,
  kPosters,
  kTrafficSigns,
  kForest,
  kCloth,
  kBroadLeaves,
  kFineLeaves,
  kPalmFrond,
  kLongLeaves,
  kBlossom,
  kHedge,
  kGrassTuft,
  kWireMesh,
};
constexpr int kPictures = static_cast<int>(Picture::kWireMesh) + 1;

// How a surface reflects. Lengths in metres.
struct Material {
  Picture picture = Picture::kPlain;
  Color tint = Color::Ones();  // multiplies the picture's colours
  float tile = 1;              // width of one tile of the picture
  float gloss = 0;             // 0 matt, 1 like window glass
  float patchiness = 0;        // strength of variation over metres to tens of metres, 0..1
  bool repaint = false;        // takes the tint of the object it is part of
  bool foliage = false;        // lets light through from behind; takes the object's tint
  bool ground = false;         // turns dark and shiny when wet
};

// All materials of a world; surfaces refer to them by number.
class Palette {
 public:
  int Add(const Material& material) {
    materials_.push_back(material);
    return static_cast<int>(materials_.size()) - 1;
  }
  const Material& operator[](int i) const { return materials_[static_cast<std::size_t>(i)]; }
  std::size_t size() const { return materials_.size(); }

 private:
  std::vector<Material> materials_;
};

}  // namespace recollect::simulation
