#include "recollect/simulation/planner.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace recollect::simulation {

Planner::Planner(const std::vector<Street>& all, Site& land, const Day& when, std::uint64_t number,
                 const Stock& things, const Plants& greens, const Vehicles& wheels, World& into)
    : streets(all),
      site(land),
      day(when),
      seed(number),
      stock(things),
      plants(greens),
      vehicles(wheels),
      world(into),
      build(into.solid, into.palette) {
  for (const Model& model : world.models) {
    float reach = 0;
    for (const Mesh* mesh : {&model.solid, &model.cutout}) {
      for (const Vec3& v : mesh->vertices) {
        if (v.z() < 2.8F) reach = std::max(reach, v.head<2>().norm());
      }
    }
    low_reach_.push_back(reach);
  }
}

Spot Planner::Beside(const Street& street, float s, bool left, float off) const {
  const auto i = static_cast<std::size_t>(std::clamp(s, 0.0F, street.length() - 1));
  const float edge = left ? street.stations[i].edge_left() : street.stations[i].edge_right();
  const Vec3 at = PointOn(street, s, left ? edge + off : -edge - off);
  const float heading = street.Heading(i) + (left ? 0 : std::numbers::pi_v<float>);
  return {Standing(site.OnGround(at), heading)};
}

void Planner::StandAt(const Spot& spot, float x, float y, float turn) {
  const Vec2 p = spot.At(x, y);
  build.Place(Standing(site.OnGround(p.x(), p.y()), spot.heading() + turn));
}

bool Planner::Claim(const Spot& spot, const Vec2& low, const Vec2& high) {
  return site.Claim({spot.At(low.x(), low.y()), spot.At(high.x(), low.y()),
                     spot.At(high.x(), high.y()), spot.At(low.x(), high.y())});
}

void Planner::Place(int model, const Vec3& at, float heading, float scale, const Color& tint) {
  Eigen::Affine3f pose(Standing(at, heading));
  pose.scale(scale);
  world.instances.push_back({model, pose, tint});
}

void Planner::Plant(const std::vector<int>& list, std::uint64_t id, const Vec2& at, float scale) {
  Random random(id);
  const int model =
      list[static_cast<std::size_t>(random.Index(static_cast<std::int64_t>(list.size())))];
  const float size = scale * Draw(random, 0.75, 1.3), turn = Draw(random, 0, 6.28318);
  const float reach = low_reach_[static_cast<std::size_t>(model)] * size;
  if (site.Clearance(at.x(), at.y()) < std::max(0.5F, reach - 0.7F)) return;
  if (!site.Claim(Rectangle(at, 0, 1.0F, 1.0F))) return;
  if (!Stands(id, 0.07)) return;
  Color tint = Plants::Tint(id, day);
  if (&list == &plants.flowering) {  // in bloom it shows its flowers, else it is green
    const bool yellow = random.Uniform() < 0.4, pink = random.Uniform() < 0.4;
    const Color bloom = yellow ? Color(1.1F, 0.75F, 0.05F)
                               : (pink ? Color(0.9F, 0.3F, 0.55F) : Color(0.9F, 0.14F, 0.04F));
    const float month = static_cast<float>(std::fmod(day.unix_time / (365.25 * 86400), 1.0)) * 12;
    const bool now =
        !day.change.season || (yellow ? month > 6.5F && month < 9.5F : month > 9 || month < 2);
    tint = now ? bloom : Color(0.2F, 0.32F, 0.08F) * tint;
  }
  Place(model, site.OnGround(at.x(), at.y()), turn, size, tint);
}

void Planner::Park(std::uint64_t id, const Vec3& at, float heading, double likely) {
  const double strength = day.change.traffic ? std::min(1.0, day.change.strength) : 0;
  // With less change, more of the cars are the same ones on all days.
  const bool same = SubSeed(id, 7) % 1000 >= static_cast<std::uint64_t>(1000 * strength);
  Random random(SubSeed(id, same ? 0 : day.seed));
  if (random.Uniform() > likely) return;
  const auto& list = random.Uniform() < 0.94 ? vehicles.cars : vehicles.lorries;
  int model = list[static_cast<std::size_t>(random.Index(static_cast<std::int64_t>(list.size())))];
  if (vehicles.lengths[static_cast<std::size_t>(model)] > 6) model = vehicles.cars.front();
  const float turn = heading + Draw(random, -0.05, 0.05) +
                     (random.Uniform() < 0.25 ? std::numbers::pi_v<float> : 0);
  Place(model, at + Vec3(Draw(random, -0.15, 0.15), Draw(random, -0.15, 0.15), 0), turn, 1,
        DrawCarPaint(random));
}

void Planner::Pave(const Spot& spot, const Vec2& low, const Vec2& high, int material, float lift) {
  build.Place(Eigen::Isometry3f::Identity());
  build.Use(material);
  const int columns = std::max(1, static_cast<int>((high.x() - low.x()) / 1.5F));
  const int rows = std::max(1, static_cast<int>((high.y() - low.y()) / 1.5F));
  const auto at = [&](int i, int j) {
    const Vec2 p = spot.At(
        low.x() + (high.x() - low.x()) * static_cast<float>(i) / static_cast<float>(columns),
        low.y() + (high.y() - low.y()) * static_cast<float>(j) / static_cast<float>(rows));
    return site.OnGround(p.x(), p.y(), 0.06F + lift);
  };
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i)
      build.Quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
  }
}

void Planner::Fence(const Spot& spot, const Vec2& from, const Vec2& to, float height) {
  MeshBuilder mesh(world.cutout, world.palette);
  mesh.Use(stock.wire_mesh);
  build.Use(stock.old_concrete);
  const int panels = std::max(1, static_cast<int>((to - from).norm() / 2.5F));
  const auto foot = [&](int i) {
    const Vec2 p = from + (to - from) * static_cast<float>(i) / static_cast<float>(panels);
    const Vec2 w = spot.At(p.x(), p.y());
    return site.OnGround(w.x(), w.y());
  };
  build.Place(Eigen::Isometry3f::Identity());
  const Vec3 up(0, 0, height);
  for (int i = 0; i < panels; ++i) {
    const Vec3 a = foot(i), b = foot(i + 1);
    mesh.Mapped(a, b, b + up, a + up, {0, 0}, {1, 1});
    build.Tube(a - up * 0.2F, a + up * 1.05F, 0.06F, 0.06F, 6);
  }
}

void Planner::Wall(const Spot& spot, const Vec2& from, const Vec2& to, float height,
                   float thickness, int material) {
  const Vec2 a = spot.At(from.x(), from.y()), b = spot.At(to.x(), to.y());
  const float length = (b - a).norm(), heading = std::atan2(b.y() - a.y(), b.x() - a.x());
  const int pieces = std::max(1, static_cast<int>(length / 4));
  for (int i = 0; i < pieces; ++i) {
    const float step = length / static_cast<float>(pieces);
    const Vec2 p = a + (b - a) * ((static_cast<float>(i) + 0.5F) / static_cast<float>(pieces));
    build.Place(Standing(site.OnGround(p.x(), p.y()), heading));
    build.Use(material);
    build.Shift(0.37F * static_cast<float>(i), 0);
    build.Box({-step / 2, -thickness / 2, -0.8F}, {step / 2, thickness / 2, height});
  }
  build.Shift(0, 0);
}

}  // namespace recollect::simulation
