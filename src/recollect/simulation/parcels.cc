#include <algorithm>
#include <cmath>

#include "recollect/simulation/building.h"
#include "recollect/simulation/furniture.h"
#include "recollect/simulation/pictures.h"
#include "recollect/simulation/planner.h"

namespace recollect::simulation {
namespace {

// One piece of land beside a street, `length` along it; y counts from the edge of the road.
class Parcel {
 public:
  Parcel(Planner& planner, const Spot& spot, float length, std::uint64_t id)
      : p_(planner), spot_(spot), length_(length), half_(length / 2), id_(id), random_(id) {}

  void Fill() {
    const double kind = random_.Uniform();
    if (kind < 0.50) {
      const float front = Draw(random_, 6.5, 13);
      if (!Building(front, false) && !Building(front + 7, false)) Grove(5, 26, 0.035F);
    } else if (kind < 0.58) {
      Grove(5, 26, 0.035F);
    } else if (kind < 0.63) {
      Lawn();
    } else if (kind < 0.70) {
      CarPark();
    } else if (kind < 0.78) {
      WalledGround();
    } else if (kind < 0.85) {
      Court();
    } else if (kind < 0.93) {
      Plaza();
    } else {
      Garden();
    }
    Backdrop();
  }

 private:
  std::uint64_t Id(std::uint64_t key) const { return SubSeed(id_, key); }
  bool Maybe(double chance) { return random_.Uniform() < chance; }

  // A house somewhere behind y = front; the walls it was drawn with, repainted now and then.
  bool Building(float front, bool tall) {
    const std::uint64_t id = Id(tall ? 20 : 10);
    const int repaints = p_.day.Changes(SubSeed(id, 1), 0.14);
    const BuildingPlan plan =
        DrawBuilding(id, repaints, std::max(9.0F, length_ - 2), 15, tall, p_.world.palette);
    const float turn = Maybe(0.25) ? Draw(random_, -0.35, 0.35) : 0;
    const float x = Draw(random_, -1, 1) * std::max(0.0F, half_ - plan.width / 2 - 1);
    const Vec2 centre = spot_.At(x, front + plan.depth / 2);
    const float heading = spot_.heading() + turn;
    const bool room = p_.site.Claim(Rectangle(centre, heading, plan.width + 1.6F, plan.depth + 2));
    if (!room) return false;
    const Vec2 foot = spot_.At(x, front);
    // Some were not there yet: first fenced ground, then a shell with scaffolding.
    const bool recent = SubSeed(id, 2) % 100 < 16;
    const int stage = recent ? p_.day.Changes(SubSeed(id, 3), 0.45) : 2;
    const Eigen::Isometry3f place = Standing(p_.site.OnGround(foot.x(), foot.y(), 0.1F), heading);
    if (stage > 0) {
      p_.build.Place(place);
      BuildBuilding(plan, p_.stock, p_.build);
    }
    if (stage < 2) {
      p_.Wall(spot_, {x - plan.width / 2, front - 1.4F}, {x + plan.width / 2, front - 1.4F}, 2.1F,
              0.06F, stage == 0 ? p_.stock.steel : p_.stock.wood);
      if (stage == 1) {
        p_.build.Place(place * Standing({0, -1.3F, 0}, 1.5707963F));
        BuildScaffold(plan.width, plan.height() + 1, p_.stock, p_.build);
      } else {
        p_.Pave(spot_, {x - plan.width / 2, front}, {x + plan.width / 2, front + plan.depth},
                p_.stock.earth);
      }
    }
    if (!tall) Surroundings(x, front, plan.width);
    return true;
  }

  void Surroundings(float x, float front, float width) {
    p_.Pave(spot_, {x - 1.2F, 3.2F}, {x + 1.2F, front},
            Maybe(0.5) ? p_.stock.slabs : p_.stock.pavers);
    if (Maybe(0.35))
      p_.Pave(spot_, {x - width / 2, front - 3}, {x + width / 2, front}, p_.stock.slabs, 0.03F);
    for (std::uint64_t k = 0; k < 8; ++k) {
      const Vec2 at = spot_.At(Draw(random_, -half_, half_), Draw(random_, 4.5, front - 0.5));
      p_.Plant(Maybe(0.6) ? p_.plants.bushes : (Maybe(0.5) ? p_.plants.palms : p_.plants.fine),
               Id(100 + k), at, 0.9F);
    }
    if (Maybe(0.4)) {
      p_.Wall(spot_, {x + 2, front - 1.2F}, {x + width / 2, front - 1.2F}, Draw(random_, 0.5, 1.1),
              0.7F, p_.stock.hedge);
    }
    if (Maybe(0.5) && p_.Stands(Id(60), 0.12)) {
      p_.StandAt(spot_, x + 3.5F, 4.6F, Draw(random_, 2.4, 3.6));
      BuildBoard(false, static_cast<int>(random_.Index(32)), 2.4F, 0.9F, p_.stock, p_.build);
    }
  }

  void Grove(float near, float far, float density) {
    const auto count = static_cast<std::uint64_t>(length_ * (far - near) * density);
    const auto& main = Species();
    for (std::uint64_t k = 0; k < count; ++k) {
      const Vec2 at = spot_.At(Draw(random_, -half_, half_), Draw(random_, near, far));
      p_.Plant(Maybe(0.7) ? main : Species(), Id(200 + k), at);
    }
  }

  const std::vector<int>& Species() {
    switch (random_.Index(6)) {
      case 0:
      case 1:
        return p_.plants.broad;
      case 2:
        return p_.plants.tall;
      case 3:
        return p_.plants.palms;
      case 4:
        return p_.plants.flowering;
      default:
        return p_.plants.fine;
    }
  }

  void Lawn() {
    for (std::uint64_t k = 0; k < 3; ++k) {
      p_.Plant(Species(), Id(300 + k), spot_.At(Draw(random_, -half_, half_), Draw(random_, 6, 18)),
               1.2F);
    }
    for (std::uint64_t k = 0; k < 24; ++k) {
      p_.Plant(p_.plants.tufts, Id(320 + k),
               spot_.At(Draw(random_, -half_, half_), Draw(random_, 4, 10)));
    }
    if (Maybe(0.55) && p_.Claim(spot_, {-2.5F, 6}, {2.5F, 8})) {
      // Hoardings get new posters.
      const auto poster = static_cast<int>(
          SubSeed(Id(61), static_cast<std::uint64_t>(p_.day.Changes(Id(61), 0.8))) % 16);
      p_.StandAt(spot_, 0, 7, 1.5708F + Draw(random_, -0.7, 0.7));
      BuildBoard(true, poster, Draw(random_, 3, 5), Draw(random_, 2, 3.2), p_.stock, p_.build);
    }
  }

  void CarPark() {
    if (!p_.Claim(spot_, {-half_ + 1, 5}, {half_ - 1, 21})) return Grove(5, 20, 0.03F);
    const int ground = Maybe(0.4)
                           ? p_.stock.gravel
                           : p_.world.palette.Add({.picture = Picture::kAsphalt,
                                                   .tint = Color::Constant(Draw(random_, 0.9, 1.8)),
                                                   .tile = 3.3F,
                                                   .patchiness = 0.6F,
                                                   .ground = true});
    p_.Pave(spot_, {-half_ + 1, 3}, {half_ - 1, 21}, ground);
    std::uint64_t k = 0;
    for (const float y : {7.6F, 18.2F}) {
      for (float x = -half_ + 3; x < half_ - 2.5F; x += 2.6F) {
        const Vec2 at = spot_.At(x, y);
        p_.Park(Id(400 + k++), p_.site.OnGround(at.x(), at.y(), 0.11F), spot_.heading() + 1.5708F,
                0.72);
        p_.build.Place(Standing(p_.site.OnGround(at.x(), at.y(), 0.12F), spot_.heading()));
        p_.build.Use(p_.stock.white_paint);
        p_.build.Quad({1.25F, -2.4F, 0}, {1.35F, -2.4F, 0}, {1.35F, 2.4F, 0}, {1.25F, 2.4F, 0});
      }
    }
    for (std::uint64_t t = 0; t < 5; ++t) {
      p_.Plant(Maybe(0.5) ? p_.plants.fine : p_.plants.broad, Id(440 + t),
               spot_.At(Draw(random_, -half_, half_), 23.5F));
    }
  }

  void WalledGround() {
    const float y = Draw(random_, 4.4, 7), height = Draw(random_, 1.1, 2.6);
    if (p_.Claim(spot_, {-half_ + 0.5F, y - 0.4F}, {half_ - 0.5F, y + 0.4F})) {
      Random paint(SubSeed(Id(62), static_cast<std::uint64_t>(p_.day.Changes(Id(62), 0.2))));
      const Picture kinds[] = {Picture::kPlaster, Picture::kStone, Picture::kBrick,
                               Picture::kConcrete};
      const auto kind = kinds[random_.Index(4)];
      const int wall = p_.world.palette.Add(
          {.picture = kind,
           .tint = kind == Picture::kPlaster ? DrawPaint(paint) : Color(Color::Ones()),
           .tile = Draw(random_, 2.2, 3.8),
           .patchiness = 0.6F});
      p_.Wall(spot_, {-half_ + 0.5F, y}, {half_ - 0.5F, y}, height, 0.25F, wall);
      for (float x = -half_ + 2; x + height < half_ - 1; x += height + Draw(random_, 0.5, 9)) {
        if (Maybe(0.5)) continue;  // a painted panel
        const Vec2 cell(static_cast<float>(paint.Index(kPosterCells)),
                        static_cast<float>(paint.Index(kPosterCells)));
        p_.StandAt(spot_, x, y - 0.14F);
        p_.build.Use(p_.stock.posters);
        p_.build.Mapped({0, 0, 0.1F}, {height, 0, 0.1F}, {height, 0, height - 0.1F},
                        {0, 0, height - 0.1F}, cell / kPosterCells,
                        (cell + Vec2::Ones()) / kPosterCells);
      }
    }
    Maybe(0.5) ? static_cast<void>(Building(y + 4, false)) : Grove(y + 3, 25, 0.04F);
  }

  void Court() {
    const float depth = 18;
    if (!p_.Claim(spot_, {-half_ + 1, 5}, {half_ - 1, 5 + depth})) return Grove(5, 20, 0.04F);
    const Color paint = Maybe(0.5) ? Color(0.2F, 0.36F, 0.26F) : Color(0.5F, 0.24F, 0.16F);
    const int ground = Maybe(0.3) ? p_.stock.earth
                                  : p_.world.palette.Add({.picture = Picture::kConcrete,
                                                          .tint = paint * 2,
                                                          .tile = 4,
                                                          .patchiness = 0.4F,
                                                          .ground = true});
    p_.Pave(spot_, {-half_ + 1, 5}, {half_ - 1, 5 + depth}, ground);
    const float h = Draw(random_, 1.8, 3.6);
    p_.Fence(spot_, {-half_ + 1, 5}, {half_ - 1, 5}, h);
    p_.Fence(spot_, {half_ - 1, 5}, {half_ - 1, 5 + depth}, h);
    p_.Fence(spot_, {-half_ + 1, 5 + depth}, {-half_ + 1, 5}, h);
    for (const float x : {-half_ + 2.5F, half_ - 2.5F}) {  // goals
      p_.StandAt(spot_, x, 5 + depth / 2);
      p_.build.Use(p_.stock.white);
      p_.build.Box({-0.05F, -1.5F, 0}, {0.05F, -1.4F, 2.1F});
      p_.build.Box({-0.05F, 1.4F, 0}, {0.05F, 1.5F, 2.1F});
      p_.build.Box({-0.05F, -1.5F, 2}, {0.05F, 1.5F, 2.1F}, true);
    }
    for (std::uint64_t k = 0; k < 7; ++k)
      p_.Plant(p_.plants.fine, Id(500 + k), spot_.At(Draw(random_, -half_, half_), depth + 8));
  }

  void Plaza() {
    const float depth = Draw(random_, 8, 16);
    p_.Pave(spot_, {-half_ + 1, 3.2F}, {half_ - 1, 4 + depth},
            Maybe(0.6) ? p_.stock.pavers : p_.stock.slabs);
    const float x = Draw(random_, -0.5, 0.5) * half_;
    if (p_.Claim(spot_, {x - 2.4F, 6}, {x + 2.4F, 10.5F}) && p_.Stands(Id(63), 0.35)) {
      // Kiosks come, go and change hands.
      Random owner(SubSeed(Id(64), static_cast<std::uint64_t>(p_.day.Changes(Id(64), 0.3))));
      p_.StandAt(spot_, x, 8.5F, 3.14159F);
      BuildKiosk(owner, p_.world.palette, p_.stock, p_.build);
    }
    for (int k = 0; k < 4; ++k) {
      const float bx = Draw(random_, -half_ + 2, half_ - 2), by = Draw(random_, 4.5, 4 + depth);
      if (!p_.Claim(spot_, {bx - 1, by - 0.5F}, {bx + 1, by + 0.5F})) continue;
      p_.StandAt(spot_, bx, by, Draw(random_, 0, 6.28));
      Maybe(0.7) ? BuildBench(p_.stock, p_.build)
                 : BuildBin(p_.stock.yellow_paint, p_.stock, p_.build);
    }
    for (std::uint64_t k = 0; k < 7; ++k) {
      p_.Plant(Maybe(0.5) ? p_.plants.palms : p_.plants.flowering, Id(600 + k),
               spot_.At(Draw(random_, -half_, half_), Draw(random_, 4.5, 5 + depth)));
    }
    if (Maybe(0.3) && p_.Claim(spot_, {-3, 12}, {3, 18})) {
      p_.StandAt(spot_, 0, 15);
      BuildWaterTower(random_, p_.stock, p_.build);
    }
  }

  void Garden() {
    for (float y = 5; y < 14; y += Draw(random_, 2, 4)) {
      const float from = Draw(random_, -half_, 0), to = Draw(random_, 1, half_);
      if (!p_.Claim(spot_, {from, y - 0.5F}, {to, y + 0.5F})) continue;
      p_.Wall(spot_, {from, y}, {to, y}, Draw(random_, 0.5, 1.5), Draw(random_, 0.5, 0.9),
              p_.stock.hedge);
    }
    for (std::uint64_t k = 0; k < 16; ++k) {
      p_.Plant(Maybe(0.6) ? p_.plants.bushes : p_.plants.flowering, Id(700 + k),
               spot_.At(Draw(random_, -half_, half_), Draw(random_, 4.5, 15)));
    }
  }

  // What is seen over and between all that: taller blocks and woods.
  void Backdrop() {
    const double kind = random_.Uniform();
    if (kind < 0.35) {
      Building(Draw(random_, 32, 60), Maybe(0.6));
    } else if (kind < 0.8) {
      Grove(26, 60, 0.011F);
    }
  }

  Planner& p_;
  const Spot& spot_;
  float length_, half_;
  std::uint64_t id_;
  Random random_;
};

}  // namespace

void FillParcels(Planner& planner) {
  for (std::size_t n = 0; n < planner.streets.size(); ++n) {
    const Street& street = planner.streets[n];
    for (const bool left : {false, true}) {
      Random random(SubSeed(SubSeed(planner.seed, n), left ? 3 : 2));
      std::uint64_t id = 0;
      for (float s = 0; s < street.length();) {
        const float length = Draw(random, 16, 44);
        const Spot spot =
            planner.Beside(street, std::min(s + length / 2, street.length() - 1), left, 0);
        Parcel(planner, spot, length, SubSeed(random.Bits(), ++id)).Fill();
        s += length + Draw(random, 0, 4);
      }
    }
  }
}

}  // namespace recollect::simulation
