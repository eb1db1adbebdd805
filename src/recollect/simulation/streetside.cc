#include <algorithm>
#include <cmath>
#include <numbers>

#include "recollect/simulation/furniture.h"
#include "recollect/simulation/planner.h"

namespace recollect::simulation {
namespace {

constexpr float kTurned = std::numbers::pi_v<float>;

class Kerbside {
 public:
  Kerbside(Planner& planner, const Street& street, std::uint64_t seed)
      : p_(planner), street_(street), seed_(seed) {}

  void Line() {
    Lamps();
    Poles();
    Signs();
    Trees();
    Things();
    ParkedCars();
  }

 private:
  // Stands the builder beside the kerb, x along the street as it is driven on the right side and
  // against it on the left, y towards the road; false where something is in the way.
  bool Stand(float s, bool left, float off, float turn = 0, float room = 0.5F) {
    const Spot spot = p_.Beside(street_, s, left, off);
    if (!p_.Claim(spot, {-room, -0.2F}, {room, 0.3F})) return false;
    p_.StandAt(spot, 0, 0, kTurned + turn);
    return true;
  }

  void Lamps() {
    Random random(SubSeed(seed_, 1));
    for (float s = 5; s < street_.length();) {
      const int kind = static_cast<int>(random.Index(12));  // of this stretch
      const float height = Draw(random, 4.2, 8.5), reach = Draw(random, 0.8, 2.2);
      const float end = s + Draw(random, 80, 220), gap = Draw(random, 21, 38);
      const bool left = random.Uniform() < 0.5;
      for (; s < std::min(end, street_.length()); s += gap + Draw(random, -4, 4)) {
        if (Stand(s, left, 0.7F)) BuildLampPost(kind, height, reach, p_.stock, p_.build);
      }
    }
  }

  void Poles() {
    Random random(SubSeed(seed_, 2));
    for (float s = Draw(random, 0, 60); s < street_.length(); s += Draw(random, 20, 90)) {
      const bool left = random.Uniform() < 0.5;
      const float height = Draw(random, 7.5, 10);
      const float end = std::min(s + Draw(random, 90, 260), street_.length());
      Vec3 last = Vec3::Zero();
      for (bool wired = false; s < end; s += Draw(random, 24, 34)) {
        const bool transformer = random.Uniform() < 0.25;
        if (!Stand(s, left, 1.3F)) continue;
        BuildPole(height, transformer, p_.stock, p_.build);
        const Vec3 top = p_.build.place() * Vec3(0, 0, height - 0.25F);
        if (wired && (top - last).norm() < 45) {
          const Vec3 across = p_.build.place().linear() * Vec3(0, 0.8F, 0);
          for (const float t : {-1.0F, 0.1F, 1.0F})
            BuildWire(last + across * t, top + across * t, p_.stock, p_.build);
          BuildWire(last - Vec3(0, 0, 2), top - Vec3(0, 0, 2), p_.stock, p_.build);
        }
        last = top;
        wired = true;
      }
    }
  }

  void Signs() {
    Random random(SubSeed(seed_, 3));
    std::uint64_t k = 0;
    for (float s = Draw(random, 5, 30); s < street_.length(); s += Draw(random, 14, 48)) {
      const std::uint64_t id = SubSeed(SubSeed(seed_, 33), k++);
      const bool left = random.Uniform() < 0.35;
      const int sign = static_cast<int>(random.Index(16));
      // Signs come and go; on the left they turn their face to us as often as their back.
      if (Stand(s, left, 0.55F, left && random.Uniform() < 0.6 ? kTurned : 0) &&
          p_.Stands(id, 0.15)) {
        BuildTrafficSign(sign, p_.stock, p_.build);
      }
    }
  }

  void Trees() {
    Random random(SubSeed(seed_, 4));
    std::uint64_t k = 0;
    for (float s = Draw(random, 0, 60); s < street_.length(); s += Draw(random, 20, 120)) {
      const bool left = random.Uniform() < 0.5;
      const auto& list = random.Uniform() < 0.5 ? p_.plants.palms : p_.plants.tall;
      const float end = std::min(s + Draw(random, 25, 90), street_.length()),
                  gap = Draw(random, 6, 12);
      for (; s < end; s += gap) {
        const Vec2 at = p_.Beside(street_, s, left, 1.1F).At(0, 0);
        p_.Plant(list, SubSeed(SubSeed(seed_, 44), k++), at, 0.95F);
      }
    }
    for (float s = 0; s < street_.length(); s += Draw(random, 0.8, 3)) {
      const bool left = random.Uniform() < 0.5;
      const Vec2 at = p_.Beside(street_, s, left, Draw(random, 1.2, 4.5)).At(0, 0);
      p_.Plant(p_.plants.tufts, SubSeed(SubSeed(seed_, 45), k++), at, 0.9F);
    }
  }

  void Things() {
    Random random(SubSeed(seed_, 5));
    std::uint64_t k = 0;
    for (float s = Draw(random, 5, 25); s < street_.length(); s += Draw(random, 9, 40)) {
      const bool left = random.Uniform() < 0.5;
      const double kind = random.Uniform();
      const std::uint64_t id = SubSeed(SubSeed(seed_, 55), k++);
      Random shape(id);
      if (kind < 0.35) {
        if (Stand(s, left, 0.6F) && p_.Stands(id, 0.3)) {
          BuildBin(shape.Uniform() < 0.5 ? p_.stock.rust : p_.stock.yellow_paint, p_.stock,
                   p_.build);
        }
      } else if (kind < 0.5) {
        if (Stand(s, left, 0.45F, 0, 2.5F))
          BuildBollards(2 + static_cast<int>(shape.Index(5)), p_.stock, p_.build);
      } else if (kind < 0.62) {
        if (Stand(s, left, 2.0F, 0, 3.2F)) BuildBusStop(shape, p_.stock, p_.build);
      } else if (kind < 0.78) {
        if (Stand(s, left, 1.0F) && p_.Stands(id, 0.25)) {
          BuildBoard(false, static_cast<int>(shape.Index(32)), 1.6F, 0.7F, p_.stock, p_.build);
        }
      } else if (kind < 0.9) {  // a cabinet of the telephone or power company
        if (!Stand(s, left, 0.9F, 0, 0.8F)) continue;
        p_.build.Use(shape.Uniform() < 0.5 ? p_.stock.steel : p_.stock.old_concrete);
        p_.build.Box({-0.5F, -0.25F, -0.2F}, {0.5F, 0.25F, Draw(shape, 0.9, 1.6)});
      } else if (p_.Stands(id, 0.8) && Stand(s, left, 0.7F, 0, 2)) {  // barriers of road works
        for (const float x : {-1.4F, 0.0F, 1.4F}) {
          p_.build.Use(x == 0 ? p_.stock.white : p_.stock.yellow_paint);
          p_.build.Box({x - 0.6F, -0.04F, 0.5F}, {x + 0.6F, 0.04F, 0.9F}, true);
          p_.build.Box({x - 0.5F, -0.2F, 0}, {x - 0.42F, 0.2F, 0.95F});
        }
      }
    }
  }

  void ParkedCars() {
    std::uint64_t k = 0;
    const std::size_t n = street_.stations.size();
    for (const bool left : {false, true}) {
      std::size_t run = 0;
      for (std::size_t i = 0; i < n; ++i) {
        const auto& station = street_.stations[i];
        run = (left ? station.bay_left : station.bay_right) > 0 ? run + 1 : 0;
        if (run < 4 || run % 6 != 4) continue;
        const float side = left ? station.half_left + 1.2F : -station.half_right - 1.2F;
        const Vec3 at = p_.site.OnGround(PointOn(street_, static_cast<float>(i), side));
        p_.Park(SubSeed(SubSeed(seed_, 66), k++), at, street_.Heading(i) + (left ? kTurned : 0),
                0.62);
      }
    }
  }

  Planner& p_;
  const Street& street_;
  std::uint64_t seed_;
};

}  // namespace

void LineStreets(Planner& planner) {
  for (std::size_t i = 0; i < planner.streets.size(); ++i) {
    Kerbside(planner, planner.streets[i], SubSeed(SubSeed(planner.seed, 0x5e), i)).Line();
  }
}

}  // namespace recollect::simulation
