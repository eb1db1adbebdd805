#include "recollect/simulation/building.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "recollect/simulation/pictures.h"

namespace recollect::simulation {
namespace {

constexpr float kFoot = -1.5F;    // walls reach so far into the ground
constexpr float kReveal = 0.16F;  // depth of a window in its wall

// An upright wall from one ground point to another; coordinates (along, up, out of the wall).
class Wall {
 public:
  Wall(const Vec2& from, const Vec2& to, MeshBuilder& build)
      : from_(from),
        along_((to - from).normalized()),
        out_(along_.y(), -along_.x()),
        length_((to - from).norm()),
        build_(build) {}

  float length() const { return length_; }
  Vec3 At(float x, float z, float out) const {
    const Vec2 p = from_ + along_ * x + out_ * out;
    return {p.x(), p.y(), z};
  }
  void Face(float x0, float x1, float z0, float z1, float out = 0) {
    if (x1 - x0 < 1e-3F || z1 - z0 < 1e-3F) return;
    build_.Quad(At(x0, z0, out), At(x1, z0, out), At(x1, z1, out), At(x0, z1, out));
  }
  void Show(float x0, float x1, float z0, float z1, float out, const Vec2& low, const Vec2& high) {
    build_.Mapped(At(x0, z0, out), At(x1, z0, out), At(x1, z1, out), At(x0, z1, out), low, high);
  }
  // A block in front of the wall.
  void Block(float x0, float x1, float z0, float z1, float out) {
    Face(x0, x1, z0, z1, out);
    build_.Quad(At(x0, z1, out), At(x1, z1, out), At(x1, z1, 0), At(x0, z1, 0));
    build_.Quad(At(x0, z0, 0), At(x1, z0, 0), At(x1, z0, out), At(x0, z0, out));
    build_.Quad(At(x0, z0, 0), At(x0, z0, out), At(x0, z1, out), At(x0, z1, 0));
    build_.Quad(At(x1, z0, out), At(x1, z0, 0), At(x1, z1, 0), At(x1, z1, out));
  }
  // The sides of a hole in the wall, `deep` into it.
  void Reveal(float x0, float x1, float z0, float z1, float deep) {
    build_.Quad(At(x0, z0, 0), At(x1, z0, 0), At(x1, z0, -deep), At(x0, z0, -deep));
    build_.Quad(At(x0, z1, -deep), At(x1, z1, -deep), At(x1, z1, 0), At(x0, z1, 0));
    build_.Quad(At(x0, z0, 0), At(x0, z0, -deep), At(x0, z1, -deep), At(x0, z1, 0));
    build_.Quad(At(x1, z0, -deep), At(x1, z0, 0), At(x1, z1, 0), At(x1, z1, -deep));
  }

 private:
  Vec2 from_, along_, out_;
  float length_;
  MeshBuilder& build_;
};

class Builder {
 public:
  Builder(const BuildingPlan& plan, const Stock& stock, MeshBuilder& build)
      : plan_(plan), stock_(stock), build_(build), random_(plan.seed) {}

  void Block(const Vec2& low, const Vec2& high, int floors, bool main) {
    const float top = static_cast<float>(floors) * plan_.floor_height;
    const std::array<Vec2, 4> corners = {low, Vec2(high.x(), low.y()), high,
                                         Vec2(low.x(), high.y())};
    for (std::size_t i = 0; i < 4; ++i) {
      Wall wall(corners[i], corners[(i + 1) % 4], build_);
      Facade(wall, floors, main && i == 0, i % 2 == 1);
    }
    if (plan_.stilts) Stilts(low, high);
    Roof(low, high, top);
  }

 private:
  using Style = BuildingPlan::Windows;

  void Facade(Wall& wall, int floors, bool front, bool gable_end) {
    const float h = plan_.floor_height;
    const int columns = std::max(1, static_cast<int>((wall.length() - 0.6F) / plan_.bay));
    const float margin = (wall.length() - static_cast<float>(columns) * plan_.bay) / 2;
    const bool blind = gable_end && random_.Uniform() < 0.4;
    const int door = front ? static_cast<int>(random_.Index(columns)) : -1;
    build_.Shift(Draw(random_, 0, 1), Draw(random_, 0, 1));
    for (int floor = 0; floor < floors; ++floor) {
      const float z = static_cast<float>(floor) * h;
      if (floor == 0 && plan_.stilts) {
        build_.Use(plan_.wall);
        continue;
      }
      build_.Use(plan_.wall);
      const float sill = z + plan_.sill, head = std::min(sill + plan_.window_height, z + h - 0.25F);
      wall.Face(0, wall.length(), floor == 0 ? kFoot : z, blind ? z + h : sill);
      if (blind) continue;
      wall.Face(0, wall.length(), head, z + h);
      wall.Face(0, margin, sill, head);
      wall.Face(wall.length() - margin, wall.length(), sill, head);
      for (int c = 0; c < columns; ++c) {
        const float x = margin + static_cast<float>(c) * plan_.bay;
        Opening(wall, x, sill, head, z, floor, front && floor == 0 && c == door);
      }
      if (plan_.bands) {
        build_.Use(plan_.accent);
        wall.Block(0, wall.length(), z + h - 0.22F, z + h, 0.07F);
      }
      if (plan_.louvres) {
        build_.Use(plan_.accent);
        for (int k = 0; k < 3; ++k) {
          const float level = head - static_cast<float>(k) * plan_.window_height / 3;
          wall.Block(margin, wall.length() - margin, level - 0.06F, level, 0.5F);
        }
      }
    }
    const float foot = plan_.stilts ? h : 0, top = static_cast<float>(floors) * h;
    if (plan_.fins && !blind) {
      build_.Use(plan_.accent);
      for (int c = 0; c <= columns; ++c) {
        const float x = margin + static_cast<float>(c) * plan_.bay;
        wall.Block(x - 0.06F, x + 0.06F, foot + 0.4F, top, 0.55F);
      }
    }
    if (random_.Uniform() < 0.6) {  // rain pipe
      build_.Use(stock_.steel);
      const float x = Draw(random_, 0.15, 0.5);
      wall.Block(x, x + 0.1F, foot, top, 0.1F);
    }
    if (front) Entrance(wall, margin + (static_cast<float>(door) + 0.5F) * plan_.bay);
    if (plan_.mural && (blind || !front) && top - foot > 3) {
      build_.Use(stock_.posters);
      const float side = std::min({wall.length() - 1, top - foot - 0.6F, 9.0F});
      const float x = Draw(random_, 0.5, wall.length() - side - 0.4);
      const Vec2 cell(static_cast<float>(random_.Index(kPosterCells)),
                      static_cast<float>(random_.Index(kPosterCells)));
      wall.Show(x, x + side, foot + 0.4F, foot + 0.4F + side, 0.04F, cell / kPosterCells,
                (cell + Vec2::Ones()) / kPosterCells);
    }
  }

  // One bay of one floor, from x on, between sill and head of its windows.
  void Opening(Wall& wall, float x, float sill, float head, float z, int floor, bool door) {
    const float w = std::min(plan_.window_width, plan_.bay - 0.1F);
    const float x0 = x + (plan_.bay - w) / 2, x1 = x0 + w;
    build_.Use(plan_.wall);
    const bool blank = !door && random_.Uniform() < plan_.blank_share;
    if (blank) {
      wall.Face(x, x + plan_.bay, sill, head);
      if (random_.Uniform() < 0.3) AirConditioner(wall, x + plan_.bay / 2, sill);
      return;
    }
    wall.Face(x, x0, sill, head);
    wall.Face(x1, x + plan_.bay, sill, head);
    wall.Reveal(x0, x1, sill, head, kReveal);
    Pane(wall, x0, x1, sill, head, -kReveal);
    build_.Use(plan_.accent);
    if (plan_.windows == Style::kPunched)
      wall.Block(x0 - 0.08F, x1 + 0.08F, sill - 0.1F, sill, 0.1F);
    if (floor > 0 && random_.Uniform() < plan_.balcony_share) Balcony(wall, x, z);
    if (random_.Uniform() < 0.05) AirConditioner(wall, x0 + 0.5F, sill - 0.75F);
    if (floor == 0 && plan_.shopfront) {
      wall.Block(x + 0.05F, x + plan_.bay - 0.05F, head + 0.1F, head + 0.16F, 1.1F);
      Pane(wall, x + 0.1F, x + plan_.bay - 0.1F, z + 0.15F, sill, 0.02F);
    }
  }

  void Pane(Wall& wall, float x0, float x1, float z0, float z1, float out) {
    build_.Use(stock_.windows);
    const Vec2 cell(static_cast<float>(random_.Index(kWindowCells)),
                    static_cast<float>(random_.Index(kWindowCells)));
    const Vec2 edge = Vec2::Constant(0.03F);
    wall.Show(x0, x1, z0, z1, out, (cell + edge) / kWindowCells,
              (cell + Vec2::Ones() - edge) / kWindowCells);
    build_.Use(stock_.window_frame);
    const int bars = std::max(1, static_cast<int>((x1 - x0) / 0.8F));
    for (int b = 0; b <= bars; ++b) {
      const float x = x0 + (x1 - x0) * static_cast<float>(b) / static_cast<float>(bars);
      wall.Face(std::max(x0, x - 0.03F), std::min(x1, x + 0.03F), z0, z1, out + 0.03F);
    }
    wall.Face(x0, x1, z0, z0 + 0.05F, out + 0.03F);
    wall.Face(x0, x1, z1 - 0.05F, z1, out + 0.03F);
    if (z1 - z0 > 1.3F) wall.Face(x0, x1, z0 + 0.7F, z0 + 0.75F, out + 0.03F);
  }

  void Balcony(Wall& wall, float x, float z) {
    build_.Use(plan_.accent);
    wall.Block(x + 0.1F, x + plan_.bay - 0.1F, z - 0.12F, z + 0.05F, 1.0F);
    build_.Use(random_.Uniform() < 0.5 ? plan_.accent : stock_.black);
    for (float t = x + 0.12F; t < x + plan_.bay - 0.15F; t += 0.3F) {
      wall.Face(t, t + 0.05F, z, z + 1.0F, 0.97F);
    }
    wall.Face(x + 0.1F, x + plan_.bay - 0.1F, z + 0.95F, z + 1.02F, 0.98F);
  }

  void AirConditioner(Wall& wall, float x, float z) {
    build_.Use(stock_.white);
    wall.Block(x - 0.38F, x + 0.38F, z, z + 0.55F, 0.32F);
    build_.Use(stock_.dark);
    wall.Face(x - 0.3F, x + 0.1F, z + 0.08F, z + 0.47F, 0.325F);
  }

  void Entrance(Wall& wall, float x) {
    x = std::clamp(x, 1.6F, std::max(1.6F, wall.length() - 1.6F));
    const float w = Draw(random_, 0.6, 1.3), h = 2.3F;
    build_.Use(random_.Uniform() < 0.5 ? stock_.wood : stock_.windows);
    wall.Face(x - w, x + w, 0, h, 0.03F);
    build_.Use(stock_.old_concrete);
    wall.Block(x - w - 0.6F, x + w + 0.6F, kFoot, 0.12F, 1.3F);
    if (plan_.portico) {
      build_.Use(plan_.accent);
      const float out = Draw(random_, 1.5, 3.2), half = w + Draw(random_, 0.4, 2);
      const float top = h + Draw(random_, 0.3, 0.8);
      wall.Block(x - half, x + half, top, top + 0.3F, out);
      for (const float side : {-half + 0.15F, half - 0.15F}) {
        build_.Tube(wall.At(x + side, kFoot, out - 0.2F), wall.At(x + side, top, out - 0.2F), 0.12F,
                    0.12F, 8, false);
      }
    }
    if (plan_.sign) {
      const float z = plan_.portico ? 3.7F : 2.55F, half = Draw(random_, 1.2, 2.6);
      Sign(wall, x, z + 0.2F, half);
    }
  }

  void Sign(Wall& wall, float x, float z, float half) {
    build_.Use(stock_.signs);
    const Vec2 cell(static_cast<float>(random_.Index(kSignColumns)),
                    static_cast<float>(random_.Index(kSignRows)));
    const Vec2 size(1.0F / kSignColumns, 1.0F / kSignRows);
    wall.Show(x - half, x + half, z, z + half / 4, 0.1F, cell.cwiseProduct(size),
              (cell + Vec2::Ones()).cwiseProduct(size));
  }

  void Stilts(const Vec2& low, const Vec2& high) {
    const float h = plan_.floor_height;
    build_.Use(stock_.old_concrete);
    build_.Quad({low.x(), high.y(), h}, {high.x(), high.y(), h}, {high.x(), low.y(), h},
                {low.x(), low.y(), h});
    const int columns = std::max(2, static_cast<int>((high.x() - low.x()) / 5));
    const int rows = std::max(2, static_cast<int>((high.y() - low.y()) / 5));
    for (int i = 0; i <= columns; ++i) {
      for (int j = 0; j <= rows; ++j) {
        const Vec2 t(static_cast<float>(i) / static_cast<float>(columns),
                     static_cast<float>(j) / static_cast<float>(rows));
        const Vec2 p =
            low + Vec2::Constant(0.4F) + (high - low - Vec2::Constant(0.8F)).cwiseProduct(t);
        build_.Box({p.x() - 0.2F, p.y() - 0.2F, kFoot}, {p.x() + 0.2F, p.y() + 0.2F, h});
      }
    }
    build_.Use(plan_.accent);
    const Vec2 inner = (high - low) * 0.22F;
    build_.Box({low.x() + inner.x(), low.y() + inner.y(), kFoot},
               {high.x() - inner.x(), high.y() - inner.y(), h});
  }

  void Roof(const Vec2& low, const Vec2& high, float z) {
    const Vec2 size = high - low, mid = (low + high) / 2;
    const float over = 0.6F;
    const Vec2 l = low - Vec2::Constant(over), h = high + Vec2::Constant(over);
    const float rise = size.y() * Draw(random_, 0.16, 0.3);
    build_.Use(plan_.roof_material);
    switch (plan_.roof) {
      case BuildingPlan::Roof::kFlat:
        FlatRoof(low, high, z);
        return;
      case BuildingPlan::Roof::kGable:
        build_.Quad({l.x(), l.y(), z}, {h.x(), l.y(), z}, {h.x(), mid.y(), z + rise},
                    {l.x(), mid.y(), z + rise});
        build_.Quad({h.x(), h.y(), z}, {l.x(), h.y(), z}, {l.x(), mid.y(), z + rise},
                    {h.x(), mid.y(), z + rise});
        build_.Use(plan_.wall);
        build_.Triangle({high.x(), low.y(), z}, {high.x(), high.y(), z},
                        {high.x(), mid.y(), z + rise});
        build_.Triangle({low.x(), high.y(), z}, {low.x(), low.y(), z},
                        {low.x(), mid.y(), z + rise});
        return;
      case BuildingPlan::Roof::kHip: {
        const float in = std::min(size.x(), size.y()) / 2;
        const Vec3 a(l.x() + in, mid.y(), z + rise), b(h.x() - in, mid.y(), z + rise);
        build_.Quad({l.x(), l.y(), z}, {h.x(), l.y(), z}, b, a);
        build_.Quad({h.x(), h.y(), z}, {l.x(), h.y(), z}, a, b);
        build_.Triangle({h.x(), l.y(), z}, {h.x(), h.y(), z}, b);
        build_.Triangle({l.x(), h.y(), z}, {l.x(), l.y(), z}, a);
        return;
      }
      case BuildingPlan::Roof::kVault: {
        constexpr int kPieces = 8;
        const auto arc = [&](int i, float x) {
          const float t = static_cast<float>(i) / kPieces;
          return Vec3(x, l.y() + (h.y() - l.y()) * t, z + rise * 1.4F * std::sin(3.14159F * t));
        };
        for (int i = 0; i < kPieces; ++i) {
          build_.Use(plan_.roof_material);
          build_.Quad(arc(i, l.x()), arc(i, h.x()), arc(i + 1, h.x()), arc(i + 1, l.x()));
          build_.Use(plan_.wall);
          build_.Triangle({high.x(), mid.y(), z}, arc(i + 1, high.x()), arc(i, high.x()));
          build_.Triangle({low.x(), mid.y(), z}, arc(i, low.x()), arc(i + 1, low.x()));
        }
        return;
      }
      default: {
        const int teeth = std::max(2, static_cast<int>(size.x() / 6));
        const float step = size.x() / static_cast<float>(teeth);
        for (int i = 0; i < teeth; ++i) {
          const float x0 = low.x() + step * static_cast<float>(i), x1 = x0 + step;
          build_.Use(plan_.roof_material);
          build_.Quad({x0, low.y(), z}, {x1, low.y(), z + 1.8F}, {x1, high.y(), z + 1.8F},
                      {x0, high.y(), z});
          build_.Use(stock_.windows);
          build_.Quad({x1, low.y(), z}, {x1, high.y(), z}, {x1, high.y(), z + 1.8F},
                      {x1, low.y(), z + 1.8F});
          build_.Use(plan_.wall);
          build_.Triangle({x0, low.y(), z}, {x1, low.y(), z}, {x1, low.y(), z + 1.8F});
          build_.Triangle({x1, high.y(), z}, {x0, high.y(), z}, {x1, high.y(), z + 1.8F});
        }
      }
    }
  }

  void FlatRoof(const Vec2& low, const Vec2& high, float z) {
    const float over = plan_.bands ? 0.5F : 0.05F, parapet = Draw(random_, 0.3, 1.1);
    build_.Use(plan_.accent);
    build_.Box({low.x() - over, low.y() - over, z}, {high.x() + over, high.y() + over, z + parapet},
               true);
    build_.Use(stock_.old_concrete);
    const Vec2 size = high - low;
    for (int i = 0; i < 4; ++i) {  // tanks, stair heads, machines
      const Vec2 p =
          low + size.cwiseProduct(Vec2(Draw(random_, 0.15, 0.85), Draw(random_, 0.25, 0.75)));
      const float half = Draw(random_, 0.5, 1.6), top = z + parapet + Draw(random_, 0.8, 2.6);
      if (i == 0) {
        build_.Tube({p.x(), p.y(), z + parapet}, {p.x(), p.y(), top}, half, half, 12);
      } else if (random_.Uniform() < 0.6) {
        build_.Box({p.x() - half, p.y() - half, z + parapet}, {p.x() + half, p.y() + half, top});
      }
    }
  }

  const BuildingPlan& plan_;
  const Stock& stock_;
  MeshBuilder& build_;
  Random random_;
};

}  // namespace

void BuildBuilding(const BuildingPlan& plan, const Stock& stock, MeshBuilder& build) {
  Builder builder(plan, stock, build);
  const Vec2 low(-plan.width / 2, 0), high(plan.width / 2, plan.depth);
  if (!plan.wing) {
    builder.Block(low, high, plan.floors, true);
    return;
  }
  // An L: a part of the front stands back, and is lower.
  const float cut = plan.width * 0.35F, back = plan.depth * 0.35F;
  builder.Block(low, Vec2(high.x() - cut, high.y()), plan.floors, true);
  builder.Block(Vec2(high.x() - cut, back), high, std::max(plan.stilts ? 2 : 1, plan.floors - 1),
                false);
}

}  // namespace recollect::simulation
