#include "recollect/simulation/furniture.h"

#include <cmath>

#include "recollect/simulation/pictures.h"

namespace recollect::simulation {
namespace {

Vec2 Cell(int cell, int columns) {
  return Vec2(static_cast<float>(cell % columns), static_cast<float>(cell / columns % columns));
}

}  // namespace

void BuildLampPost(int kind, float height, float reach, const Stock& stock, MeshBuilder& build) {
  build.Use(kind % 3 == 0 ? stock.old_concrete : (kind % 3 == 1 ? stock.steel : stock.black));
  build.Tube({0, 0, -0.3F}, {0, 0, height}, 0.10F, 0.06F, 8);
  if (kind % 4 == 3) {  // a ball on top
    build.Use(stock.white);
    build.Ball({0, 0, height + 0.2F}, {0.25F, 0.25F, 0.25F}, 10);
    return;
  }
  build.Tube({0, 0, height - 0.1F}, {0, reach, height + 0.5F}, 0.05F, 0.04F, 6);
  build.Use(stock.steel);
  build.Box({-0.12F, reach - 0.3F, height + 0.4F}, {0.12F, reach + 0.4F, height + 0.55F}, true);
  if (kind % 2 == 0) {
    build.Tube({0, 0, height - 0.1F}, {0, -reach, height + 0.5F}, 0.05F, 0.04F, 6);
    build.Box({-0.12F, -reach - 0.4F, height + 0.4F}, {0.12F, -reach + 0.3F, height + 0.55F}, true);
  }
}

void BuildPole(float height, bool transformer, const Stock& stock, MeshBuilder& build) {
  build.Use(stock.old_concrete);
  build.Tube({0, 0, -0.5F}, {0, 0, height}, 0.17F, 0.11F, 8);
  build.Use(stock.wood);
  build.Box({-0.06F, -0.9F, height - 0.4F}, {0.06F, 0.9F, height - 0.28F}, true);
  build.Box({-0.06F, -0.6F, height - 1.4F}, {0.06F, 0.6F, height - 1.3F}, true);
  if (transformer) {
    build.Use(stock.steel);
    build.Tube({0.35F, 0, height - 2.8F}, {0.35F, 0, height - 1.7F}, 0.3F, 0.3F, 10);
  }
}

void BuildWire(const Vec3& a, const Vec3& b, const Stock& stock, MeshBuilder& build) {
  build.Place(Eigen::Isometry3f::Identity());
  build.Use(stock.black);
  constexpr int kPieces = 8;
  const auto at = [&](int i) {
    const float t = static_cast<float>(i) / kPieces;
    return Vec3(a + (b - a) * t - Vec3::UnitZ() * (4 * t * (1 - t) * (b - a).norm() * 0.02F));
  };
  for (int i = 0; i < kPieces; ++i) build.Tube(at(i), at(i + 1), 0.016F, 0.016F, 3, false);
}

void BuildTrafficSign(int sign, const Stock& stock, MeshBuilder& build) {
  build.Use(stock.steel);
  build.Tube({0, 0, -0.3F}, {0, 0, 2.7F}, 0.035F, 0.035F, 6);
  const int sides = sign < 5 || (sign > 10 && sign < 14) ? 16 : (sign == 5 ? 8 : 4);
  const float turn = sign > 5 && sign < 11 ? 0.0F : 3.14159F / static_cast<float>(sides);
  const float radius = sides == 4 && turn > 0 ? 0.46F : 0.36F;
  const Vec2 low = Cell(sign, kTrafficCells) / kTrafficCells;
  const Vec2 high = low + Vec2::Constant(1.0F / kTrafficCells);
  std::vector<Vec3> rim;
  for (int i = 0; i < sides; ++i) {
    const float angle = turn + 6.28318F * static_cast<float>(i) / static_cast<float>(sides);
    rim.emplace_back(-0.045F, -radius * std::cos(angle), 2.35F + radius * std::sin(angle));
  }
  build.Use(stock.traffic_signs);
  const auto& c = Vec3(-0.045F, 0, 2.35F);
  for (int i = 0; i < sides; i += 2) {  // pieces of one picture: equal gradients, shifted corners
    const Vec3& p = rim[static_cast<std::size_t>(i)];
    const Vec3& q = rim[static_cast<std::size_t>((i + 1) % sides)];
    const Vec3& r = rim[static_cast<std::size_t>((i + 2) % sides)];
    build.Sheet({c, p, q, r}, Vec3(-0.045F, 0.36F, 1.99F), Vec3(-0.045F, -0.36F, 1.99F),
                Vec3(-0.045F, 0.36F, 2.71F), low, high);
  }
  build.Use(stock.steel);
  build.Quad(rim[0] + Vec3(0.01F, 0, 0),
             rim[static_cast<std::size_t>(3 * sides / 4)] + Vec3(0.01F, 0, 0),
             rim[static_cast<std::size_t>(sides / 2)] + Vec3(0.01F, 0, 0),
             rim[static_cast<std::size_t>(sides / 4)] + Vec3(0.01F, 0, 0));
}

void BuildBoard(bool poster, int cell, float width, float height, const Stock& stock,
                MeshBuilder& build) {
  build.Use(stock.steel);
  const float w = width / 2, foot = poster ? 1.2F : 0.7F;
  for (const float y : {-w * 0.8F, w * 0.8F})
    build.Tube({0.06F, y, -0.3F}, {0.06F, y, foot + height}, 0.06F, 0.06F, 6);
  build.Box({0.005F, -w, foot}, {0.05F, w, foot + height}, true);
  build.Use(poster ? stock.posters : stock.signs);
  Vec2 low, size;
  if (poster) {
    size = Vec2::Constant(1.0F / kPosterCells);
    low = Cell(cell, kPosterCells) / kPosterCells;
  } else {
    size = Vec2(1.0F / kSignColumns, 1.0F / kSignRows);
    low = Vec2(static_cast<float>(cell % kSignColumns),
               static_cast<float>(cell / kSignColumns % kSignRows))
              .cwiseProduct(size);
  }
  build.Mapped({0, w, foot}, {0, -w, foot}, {0, -w, foot + height}, {0, w, foot + height}, low,
               low + size);
}

void BuildBench(const Stock& stock, MeshBuilder& build) {
  build.Use(stock.wood);
  build.Box({-0.8F, -0.22F, 0.42F}, {0.8F, 0.22F, 0.48F}, true);
  build.Box({-0.8F, -0.26F, 0.6F}, {0.8F, -0.22F, 0.9F}, true);
  build.Use(stock.old_concrete);
  for (const float x : {-0.6F, 0.6F}) build.Box({x - 0.06F, -0.25F, 0}, {x + 0.06F, 0.2F, 0.42F});
}

void BuildBin(int material, const Stock& stock, MeshBuilder& build) {
  build.Use(material);
  build.Tube({0, 0, 0}, {0, 0, 0.9F}, 0.24F, 0.3F, 10);
  build.Use(stock.black);
  build.Tube({0, 0, 0.9F}, {0, 0, 0.98F}, 0.32F, 0.1F, 10);
}

void BuildBollards(int count, const Stock& stock, MeshBuilder& build) {
  for (int i = 0; i < count; ++i) {
    const float x = 1.3F * static_cast<float>(i);
    build.Use(stock.yellow_paint);
    build.Tube({x, 0, 0}, {x, 0, 0.55F}, 0.09F, 0.09F, 8);
    build.Use(stock.black);
    build.Tube({x, 0, 0.55F}, {x, 0, 0.8F}, 0.09F, 0.08F, 8);
  }
}

void BuildBusStop(Random& random, const Stock& stock, MeshBuilder& build) {
  const float w = Draw(random, 1.8, 3.2);
  build.Use(stock.steel);
  for (const float x : {-w, w}) build.Tube({x, -0.7F, 0}, {x, -0.7F, 2.5F}, 0.06F, 0.06F, 6);
  build.Use(random.Uniform() < 0.5 ? stock.rust : stock.old_concrete);
  build.Box({-w - 0.3F, -1.1F, 2.5F}, {w + 0.3F, 1.0F, 2.65F}, true);
  build.Use(random.Uniform() < 0.5 ? stock.glass : stock.old_concrete);
  build.Box({-w, -0.75F, 0.4F}, {w, -0.68F, 2.2F}, true);
  build.Use(stock.posters);
  const Vec2 low = Cell(static_cast<int>(random.Index(16)), kPosterCells) / kPosterCells;
  build.Mapped({-w + 1.1F, -0.66F, 0.7F}, {-w + 0.1F, -0.66F, 0.7F}, {-w + 0.1F, -0.66F, 2},
               {-w + 1.1F, -0.66F, 2}, low, low + Vec2::Constant(1.0F / kPosterCells));
  build.Use(stock.wood);
  build.Box({-w * 0.5F, -0.6F, 0.42F}, {w * 0.8F, -0.2F, 0.48F}, true);
}

void BuildKiosk(Random& random, Palette& palette, const Stock& stock, MeshBuilder& build) {
  const int wall =
      palette.Add({.picture = random.Uniform() < 0.5 ? Picture::kMetal : Picture::kPlaster,
                   .tint = DrawPaint(random),
                   .tile = 2,
                   .patchiness = 0.3F});
  const int cloth =
      palette.Add({.picture = Picture::kCloth, .tint = DrawPaint(random), .tile = 1.4F});
  const float w = Draw(random, 1.2, 2), h = Draw(random, 2.3, 2.8);
  build.Use(wall);
  build.Box({-w, -1.3F, 0}, {w, 1.3F, h});
  build.Use(cloth);
  build.Quad({w, 1.3F, h}, {-w, 1.3F, h}, {-w - 0.1F, 2.6F, h - 0.55F},
             {w + 0.1F, 2.6F, h - 0.55F});
  build.Use(stock.dark);
  build.Box({-w + 0.3F, 1.29F, 1.05F}, {w - 0.3F, 1.31F, 2.05F}, true);
  build.Use(stock.signs);
  const Vec2 size(1.0F / kSignColumns, 1.0F / kSignRows);
  const int cell = static_cast<int>(random.Index(32));
  const Vec2 low =
      Vec2(static_cast<float>(cell % 2), static_cast<float>(cell / 2)).cwiseProduct(size);
  build.Mapped({w * 0.9F, 1.35F, h}, {-w * 0.9F, 1.35F, h}, {-w * 0.9F, 1.35F, h + w * 0.45F},
               {w * 0.9F, 1.35F, h + w * 0.45F}, low, low + size);
}

void BuildWaterTower(Random& random, const Stock& stock, MeshBuilder& build) {
  const float h = Draw(random, 9, 15), r = Draw(random, 1.6, 2.6);
  build.Use(stock.old_concrete);
  for (int i = 0; i < 5; ++i) {
    const float a = 1.2566F * static_cast<float>(i);
    build.Tube({r * std::cos(a), r * std::sin(a), -1},
               {r * 0.8F * std::cos(a), r * 0.8F * std::sin(a), h}, 0.2F, 0.18F, 6, false);
  }
  build.Use(random.Uniform() < 0.5 ? stock.white : stock.rust);
  build.Tube({0, 0, h - 0.8F}, {0, 0, h}, 0.4F, r * 1.15F, 16, false);
  build.Tube({0, 0, h}, {0, 0, h + 3}, r * 1.15F, r * 1.15F, 16, false);
  build.Tube({0, 0, h + 3}, {0, 0, h + 3.8F}, r * 1.15F, 0.2F, 16);
}

void BuildScaffold(float width, float height, const Stock& stock, MeshBuilder& build) {
  build.Use(stock.steel);
  for (float y = -width / 2; y <= width / 2; y += 2) {
    for (const float x : {0.0F, 1.2F})
      build.Tube({x, y, -0.5F}, {x, y, height}, 0.04F, 0.04F, 5, false);
  }
  for (float z = 1.9F; z < height; z += 1.9F) {
    build.Use(stock.wood);
    build.Box({0, -width / 2, z}, {1.2F, width / 2, z + 0.06F}, true);
    build.Use(stock.steel);
    build.Tube({0, -width / 2, z + 1}, {0, width / 2, z + 1}, 0.03F, 0.03F, 5, false);
  }
}

}  // namespace recollect::simulation
