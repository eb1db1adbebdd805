#include <cmath>
#include <numbers>

#include "recollect/simulation/noise.h"
#include "recollect/simulation/roadworks.h"

namespace recollect::simulation {
namespace {

constexpr float kCell = 4;
constexpr float kSunken = 0.25F;  // how far the land lies below the road that covers it

// A sheet of quads over a grid of points with normals shared between neighbours.
template <typename Point>
void AddSheet(int columns, int rows, const Point& point, int material, MeshBuilder& build,
              Mesh& mesh) {
  build.Use(material);
  const auto normal = [&](int i, int j) {
    const Vec3 du = point(std::min(i + 1, columns), j) - point(std::max(i - 1, 0), j);
    const Vec3 dv = point(i, std::min(j + 1, rows)) - point(i, std::max(j - 1, 0));
    return Vec3(du.cross(dv).normalized());
  };
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      build.Quad(point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1));
      for (const auto& [x, y] : {std::pair{i, j}, {i + 1, j}, {i + 1, j + 1}, {i, j + 1}}) {
        mesh.normals.push_back(normal(x, y));
      }
    }
  }
}

}  // namespace

void BuildTerrain(const Site& site, const Day& day, std::uint64_t seed, const Stock& stock,
                  World& world) {
  Model land;
  MeshBuilder build(land.solid, world.palette);
  const Vec2 size = site.high() - site.low();
  const int columns = static_cast<int>(size.x() / kCell), rows = static_cast<int>(size.y() / kCell);
  Material lawn = world.palette[stock.grass];
  lawn.tint *= Color(1, 1, 1) + Color(0.75F, 0.35F, 0.3F) * day.dryness;
  const int grass = world.palette.Add(lawn);
  AddSheet(
      columns, rows,
      [&](int i, int j) {
        const float x = site.low().x() + kCell * static_cast<float>(i);
        const float y = site.low().y() + kCell * static_cast<float>(j);
        return site.OnGround(x, y, site.Clearance(x, y) < 2.6F ? -kSunken : 0.06F);
      },
      grass, build, land.solid);

  // Hills in a ring around the land: wooded, some of bare rock.
  const Vec2 centre = (site.low() + site.high()) / 2;
  const auto hills = static_cast<std::uint32_t>(SubSeed(seed, 1));
  constexpr int kAround = 160, kOut = 24;
  AddSheet(
      kOut, kAround,
      [&](int i, int j) {
        const float angle =
            2 * std::numbers::pi_v<float> * static_cast<float>(j % kAround) / kAround;
        const float out = static_cast<float>(i) / kOut;
        const Vec2 ray(std::cos(angle), std::sin(angle));
        // The ring begins just inside the edge of the land, which is a rectangle.
        const float inner = std::min(size.x() / std::max(1e-3F, std::abs(ray.x())),
                                     size.y() / std::max(1e-3F, std::abs(ray.y()))) /
                                2 -
                            8;
        const Vec2 p = centre + (inner + 2600 * out * out + 60 * out) * ray;
        const float ridge = Fbm(p.x() / 420 + 100, p.y() / 420 + 100, 4096, 5, hills);
        const float height = SmoothStep(0.08F, 0.6F, out) * std::max(0.0F, ridge - 0.3F) * 520;
        return Vec3(p.x(), p.y(), height - 6);
      },
      stock.forest, build, land.solid);
  world.instances.push_back({.model = world.AddModel(std::move(land))});
}

}  // namespace recollect::simulation
