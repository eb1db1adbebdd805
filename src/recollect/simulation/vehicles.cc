#include "recollect/simulation/vehicles.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "recollect/simulation/pictures.h"

namespace recollect::simulation {
namespace {

// One corner line of a body's side view: along the car, up, and half the width there.
struct Rib {
  float x, z, half;
};

class VehicleMaker {
 public:
  VehicleMaker(const Stock& stock, const Palette& palette)
      : stock_(stock), build_(model_.solid, palette) {}

  // Skin between two ribs across the whole width.
  void Skin(const Rib& a, const Rib& b) {
    build_.Quad({a.x, -a.half, a.z}, {b.x, -b.half, b.z}, {b.x, b.half, b.z}, {a.x, a.half, a.z});
  }
  // The sides below a line of ribs down to z.
  void Sides(const std::vector<Rib>& ribs, float z, float tuck) {
    for (std::size_t i = 0; i + 1 < ribs.size(); ++i) {
      const Rib &a = ribs[i], &b = ribs[i + 1];
      build_.Quad({a.x, -a.half - tuck, z}, {b.x, -b.half - tuck, z}, {b.x, -b.half, b.z},
                  {a.x, -a.half, a.z});
      build_.Quad({b.x, b.half + tuck, z}, {a.x, a.half + tuck, z}, {a.x, a.half, a.z},
                  {b.x, b.half, b.z});
    }
  }
  void Wheels(const std::vector<float>& xs, float radius, float half) {
    for (const float x : xs) {
      for (const float side : {-1.0F, 1.0F}) {
        build_.Use(stock_.rubber);
        const Vec3 in(x, side * (half - 0.2F), radius), out(x, side * (half + 0.015F), radius);
        build_.Tube(in, out, radius, radius, 14);
        build_.Use(stock_.chrome);
        build_.Tube(out, out + Vec3(0, side * 0.01F, 0), radius * 0.62F, radius * 0.55F, 10);
      }
    }
  }

  Model Car(Random& random, int kind) {
    const float length = kind == 0 ? Draw(random, 3.5, 3.9) : Draw(random, 4.1, 4.8);
    const bool tall = kind == 2, box = kind == 0 || kind == 2;
    const float half = Draw(random, 0.80, 0.92), f = length / 2, base = 0.22F;
    const float belt = tall ? 1.08F : Draw(random, 0.86, 0.95),
                roof = tall ? 1.72F : Draw(random, 1.4, 1.52);
    const float hood = f - Draw(random, 0.85, 1.15), screen = hood - Draw(random, 0.55, 0.8);
    const float back = box ? -f + 0.15F : -f + Draw(random, 0.5, 0.8);
    const float rear = kind == 3 ? -0.25F : (box ? -f + 0.45F : back + 0.5F);
    build_.Use(stock_.paint);
    const std::vector<Rib> body = {
        {f, 0.55F, half * 0.92F},         {f - 0.12F, belt - 0.2F, half * 0.95F},
        {hood, belt, half * 0.97F},       {back, belt + 0.03F, half * 0.97F},
        {-f + 0.04F, belt, half * 0.94F}, {-f, 0.55F, half * 0.92F}};
    for (std::size_t i = 0; i + 1 < body.size(); ++i) Skin(body[i + 1], body[i]);
    std::vector<Rib> reverse(body.rbegin(), body.rend());
    Sides(reverse, base + 0.1F, 0.03F);
    build_.Quad({f, -half, base}, {f, half, base}, {f, half * 0.92F, 0.55F},
                {f, -half * 0.92F, 0.55F});
    build_.Quad({-f, half, base}, {-f, -half, base}, {-f, -half * 0.92F, 0.55F},
                {-f, half * 0.92F, 0.55F});
    // The cabin: glass all round under a painted roof.
    const float in = half * 0.78F, cabin_back = kind == 3 ? -0.75F : back;
    const Rib a{hood, belt, half * 0.93F}, b{screen, roof, in}, c{rear, roof, in},
        d{cabin_back, belt + 0.03F, half * 0.93F};
    Skin(c, b);
    build_.Use(stock_.car_glass);
    Skin(b, a);
    Skin(d, c);
    for (const float s : {-1.0F, 1.0F}) {
      const Vec3 p0(d.x, s * d.half, d.z), p1(a.x, s * a.half, a.z), p2(b.x, s * b.half, b.z),
          p3(c.x, s * c.half, c.z);
      s < 0 ? build_.Quad(p0, p1, p2, p3) : build_.Quad(p1, p0, p3, p2);
      build_.Use(stock_.paint);  // pillars
      for (const float x : {0.0F, 0.38F}) {
        const float t = (rear + screen) / 2 + x - 0.2F;
        const Vec3 foot(t, s * (half * 0.93F + 0.01F), belt), head(t, s * (in + 0.012F), roof);
        const Vec3 w(0.07F, 0, 0);
        if (x > 0) continue;
        s < 0 ? build_.Quad(foot - w, foot + w, head + w, head - w)
              : build_.Quad(foot + w, foot - w, head - w, head + w);
      }
      build_.Use(stock_.car_glass);
    }
    if (kind == 3) {  // a pick-up's open bed
      build_.Use(stock_.dark);
      build_.Quad({-f + 0.1F, -half * 0.85F, belt + 0.035F}, {-0.85F, -half * 0.85F, belt + 0.035F},
                  {-0.85F, half * 0.85F, belt + 0.035F}, {-f + 0.1F, half * 0.85F, belt + 0.035F});
    }
    Lamps(f, half, 0.62F, 0.8F);
    Plate(f, 0.42F);
    Under(f, half, base);
    Wheels({f - 0.75F, -f + 0.75F}, tall ? 0.36F : 0.31F, half);
    return std::move(model_);
  }

  Model Bus(Random& random, int kind) {
    const float length = kind == 0 ? 10.5F : (kind == 1 ? 5.6F : 7.5F), f = length / 2;
    const float half = kind == 1 ? 1.0F : 1.22F, top = kind == 0 ? 3.1F : (kind == 1 ? 2.3F : 2.5F);
    const float cab = kind == 2 ? f - 1.9F : -f;  // a lorry's cab ends here
    build_.Use(stock_.paint);
    build_.Box({cab, -half, 0.4F}, {f, half, top}, true);
    if (kind == 2) {
      build_.Use(random.Uniform() < 0.5 ? stock_.white : stock_.steel);
      build_.Box({-f, -half - 0.05F, 0.8F}, {cab - 0.15F, half + 0.05F, Draw(random, 2.8, 3.4)},
                 true);
      build_.Use(stock_.posters);
      for (const float s : {-1.0F, 1.0F}) {
        const Vec2 cell(static_cast<float>(random.Index(kPosterCells)),
                        static_cast<float>(random.Index(kPosterCells)));
        const float y = s * (half + 0.06F), x0 = s < 0 ? -f + 1 : cab - 1.5F,
                    x1 = s < 0 ? cab - 1.5F : -f + 1;
        build_.Mapped({x0, y, 1.1F}, {x1, y, 1.1F}, {x1, y, 2.5F}, {x0, y, 2.5F},
                      cell / kPosterCells, (cell + Vec2::Ones()) / kPosterCells);
      }
      build_.Use(stock_.dark);
      build_.Box({-f, -half * 0.8F, 0.45F}, {cab, half * 0.8F, 0.8F}, true);
    }
    build_.Use(stock_.car_glass);
    const float low = top * 0.5F, high = top - 0.25F;
    build_.Quad({f + 0.01F, -half + 0.1F, low}, {f + 0.01F, half - 0.1F, low},
                {f + 0.01F, half - 0.12F, high}, {f + 0.01F, -half + 0.12F, high});
    if (kind != 2) {
      build_.Quad({-f - 0.01F, half - 0.2F, low}, {-f - 0.01F, -half + 0.2F, low},
                  {-f - 0.01F, -half + 0.2F, high - 0.1F}, {-f - 0.01F, half - 0.2F, high - 0.1F});
    }
    const float pane = kind == 0 ? 1.5F : 1.3F;
    for (float x = f - 0.3F; x - pane > cab + 0.2F; x -= pane + 0.12F) {
      for (const float s : {-1.0F, 1.0F}) {
        const float y = s * (half + 0.01F), x0 = s < 0 ? x - pane : x, x1 = s < 0 ? x : x - pane;
        build_.Quad({x0, y, low}, {x1, y, low}, {x1, y, high}, {x0, y, high});
      }
    }
    if (kind == 0) {
      build_.Use(random.Uniform() < 0.5 ? stock_.yellow_paint : stock_.white);
      build_.Box({-f - 0.012F, -half - 0.012F, 0.8F}, {f + 0.012F, half + 0.012F, 1.05F});
    }
    Lamps(f, half, 0.7F, 1.1F);
    Plate(f, 0.5F);
    Under(f, half, 0.4F);
    Wheels({f - 1.1F, -f + 1.5F}, kind == 1 ? 0.35F : 0.48F, half);
    return std::move(model_);
  }

  // Someone on the way, in mid-stride.
  Model Person(Random& random, Palette& palette) {
    const auto cloth = [&](double low, double high) {
      return palette.Add(
          {.picture = Picture::kCloth,
           .tint = Color(Draw(random, low, high), Draw(random, low, high), Draw(random, low, high)),
           .tile = 0.8F});
    };
    const int skin = palette.Add({.tint = Color(0.42F, 0.24F, 0.16F) * Draw(random, 0.35, 1.4)});
    const float stride = Draw(random, 0.1, 0.3), tall = Draw(random, 0.9, 1.06);
    const int shirt = cloth(0.05, 0.9);
    build_.Use(cloth(0.03, 0.35));
    for (const float s : {-1.0F, 1.0F}) {
      build_.Tube({s * stride, s * 0.09F, 0.05F}, {0, s * 0.09F, 0.85F * tall}, 0.06F, 0.09F, 7);
    }
    build_.Use(shirt);
    build_.Ball({0, 0, 1.12F * tall}, {0.14F, 0.21F, 0.33F * tall}, 10);
    for (const float s : {-1.0F, 1.0F}) {
      build_.Tube({0, s * 0.22F, 1.36F * tall}, {-s * stride * 0.8F, s * 0.27F, 0.95F * tall},
                  0.055F, 0.045F, 6);
    }
    build_.Use(skin);
    build_.Ball({0.01F, 0, 1.58F * tall}, {0.1F, 0.09F, 0.13F}, 10);
    build_.Use(stock_.black);
    build_.Ball({-0.02F, 0, 1.63F * tall}, {0.1F, 0.095F, 0.1F}, 8);
    if (random.Uniform() < 0.5) {
      build_.Use(shirt);
      build_.Box({-0.32F, -0.14F, 0.95F * tall}, {-0.13F, 0.14F, 1.4F * tall}, true);
    }
    return std::move(model_);
  }

 private:
  void Lamps(float f, float half, float z0, float z1) {
    for (const float s : {-1.0F, 1.0F}) {
      const float y = s * (half - 0.22F);
      build_.Use(stock_.head_lamp);
      build_.Box({f - 0.2F, y - 0.15F, z0 - 0.05F}, {f + 0.005F, y + 0.15F, z0 + 0.1F}, true);
      build_.Use(stock_.tail_lamp);
      build_.Box({-f - 0.008F, y - 0.12F, z0}, {-f + 0.2F, y + 0.14F, z1}, true);
    }
  }
  void Plate(float f, float z) {
    build_.Use(stock_.white);
    build_.Box({-f - 0.015F, -0.2F, z}, {f + 0.01F, 0.2F, z + 0.13F}, true);
  }
  void Under(float f, float half, float z) {
    build_.Use(stock_.dark);
    build_.Box({-f + 0.15F, -half + 0.1F, 0.13F}, {f - 0.15F, half - 0.1F, z + 0.02F}, true);
  }

  const Stock& stock_;
  Model model_;
  MeshBuilder build_;
};

}  // namespace

Vehicles::Vehicles(std::uint64_t seed, const Stock& stock, World& world) {
  Random random(seed);
  const auto add = [&](std::vector<int>& list, Model model) {
    float reach = 0;
    for (const Vec3& v : model.solid.vertices) reach = std::max(reach, v.x());
    list.push_back(world.AddModel(std::move(model)));
    lengths.resize(world.models.size(), 0);
    lengths.back() = 2 * reach;
  };
  for (int i = 0; i < 10; ++i) add(cars, VehicleMaker(stock, world.palette).Car(random, i % 4));
  for (int i = 0; i < 6; ++i) add(lorries, VehicleMaker(stock, world.palette).Bus(random, i % 3));
  for (int i = 0; i < 12; ++i) {
    add(people, VehicleMaker(stock, world.palette).Person(random, world.palette));
  }
}

Color DrawCarPaint(Random& random) {
  static const std::array<Color, 10> kPaints = {
      Color(0.75F, 0.75F, 0.74F), Color(0.75F, 0.75F, 0.74F),  Color(0.40F, 0.41F, 0.43F),
      Color(0.38F, 0.38F, 0.38F), Color(0.02F, 0.02F, 0.022F), Color(0.10F, 0.10F, 0.11F),
      Color(0.42F, 0.03F, 0.03F), Color(0.04F, 0.09F, 0.28F),  Color(0.30F, 0.26F, 0.20F),
      Color(0.06F, 0.18F, 0.10F)};
  return kPaints[static_cast<std::size_t>(random.Index(10))] * Draw(random, 0.8, 1.15);
}

}  // namespace recollect::simulation
