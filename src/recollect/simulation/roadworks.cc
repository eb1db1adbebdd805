#include "recollect/simulation/roadworks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "recollect/simulation/noise.h"

namespace recollect::simulation {
namespace {

constexpr float kKerbHeight = 0.14F, kKerbWidth = 0.16F;
constexpr float kVergeStretch = 37;  // metres between possible changes of a verge

// Lays one street; positions are given as metres along it and to the left of its middle.
class RoadLayer {
 public:
  RoadLayer(const Street& street, const Site& site, const Day& day, std::uint64_t seed,
            const Stock& stock, World& world)
      : street_(street),
        site_(site),
        day_(day),
        seed_(seed),
        stock_(stock),
        world_(world),
        build_(world.solid, world.palette) {}

  void Lay() {
    const std::size_t pieces = street_.stations.size() - (street_.closed ? 0 : 1);
    LayTar(pieces);
    for (std::size_t i = 0; i < pieces; ++i) {
      LaySide(i, true);
      LaySide(i, false);
    }
    MarkLanes();
    Mend();
    AddCrossings();
  }

 private:
  const Street::Station& Station(std::size_t i) const {
    return street_.stations[i % street_.stations.size()];
  }
  Vec3 At(float s, float side, float lift) const {
    return site_.OnGround(PointOn(street_, s, side), lift);
  }
  // A strip on the road from s0 to s1, between two distances to the left.
  void Strip(float s0, float s1, float side0, float side1, float lift) {
    build_.Quad(At(s0, side0, lift), At(s1, side0, lift), At(s1, side1, lift), At(s0, side1, lift));
  }

  void LayTar(std::size_t pieces) {
    Random random(SubSeed(seed_, 1));
    std::size_t change = 0;
    for (std::size_t i = 0; i < pieces; ++i) {
      if (i == change) {  // roads are mended and tarred anew piece by piece
        const float tone = Draw(random, 0.75, 1.5), warm = Draw(random, 0.96, 1.08);
        build_.Use(world_.palette.Add({.picture = Picture::kAsphalt,
                                       .tint = Color(warm, 1, 2 - warm) * tone,
                                       .tile = Draw(random, 2.6, 4.2),
                                       .patchiness = Draw(random, 0.4, 0.9),
                                       .ground = true}));
        change += static_cast<std::size_t>(random.Uniform(35, 140));
      }
      const auto& a = Station(i);
      const auto& b = Station(i + 1);
      const float s = static_cast<float>(i);
      build_.Quad(At(s, -a.edge_right(), 0), At(s + 1, -b.edge_right(), 0),
                  At(s + 1, b.edge_left(), 0), At(s, a.edge_left(), 0));
    }
  }

  // Kerb and verge of one metre of one side.
  void LaySide(std::size_t i, bool left) {
    const float s = static_cast<float>(i), sign = left ? 1.0F : -1.0F;
    const float e0 = left ? Station(i).edge_left() : Station(i).edge_right();
    const float e1 = left ? Station(i + 1).edge_left() : Station(i + 1).edge_right();
    // On the inside of a tight bend, and where another street comes in, there is road instead.
    const Vec3 probe = PointOn(street_, s + 0.5F, sign * ((e0 + e1) / 2 + 1.0F));
    if (site_.Clearance(probe.x(), probe.y()) < 0.5F) return;
    const float w0 = VergeWidth(street_, seed_, s, left),
                w1 = VergeWidth(street_, seed_, s + 1, left);
    const auto quad = [&](float o0, float o1, float z0, float p0, float p1, float z1) {
      const Vec3 a = At(s, sign * (e0 + o0), z0), b = At(s + 1, sign * (e1 + o1), z0);
      const Vec3 c = At(s + 1, sign * (e1 + p1), z1), d = At(s, sign * (e0 + p0), z1);
      if (left) {
        build_.Quad(a, b, c, d);
      } else {
        build_.Quad(b, a, d, c);
      }
    };
    build_.Use(stock_.kerb);
    quad(0, 0, -0.05F, 0, 0, kKerbHeight);
    quad(0, 0, kKerbHeight, kKerbWidth, kKerbWidth, kKerbHeight);
    build_.Use(VergeMaterial(s, left));
    quad(kKerbWidth, kKerbWidth, kKerbHeight, w0, w1, kKerbHeight);
    quad(w0, w1, kKerbHeight, w0 + 0.3F, w1 + 0.3F, -0.5F);
  }

  int VergeMaterial(float s, bool left) const {
    const auto piece = static_cast<std::uint64_t>(s / kVergeStretch) * 2 + (left ? 1 : 0);
    const std::array<int, 8> kinds = {stock_.slabs, stock_.slabs, stock_.pavers,
                                      stock_.grass, stock_.grass, stock_.old_concrete,
                                      stock_.earth, stock_.gravel};
    return kinds[SubSeed(SubSeed(seed_, 2), piece) % kinds.size()];
  }

  void MarkLanes() {
    Random random(SubSeed(seed_, 3));
    const float length = street_.length();
    for (float s = 0; s < length;) {
      const float end = std::min(length, s + Draw(random, 40, 130));
      const int kind = static_cast<int>(random.Index(4));
      build_.Use(kind == 3 ? stock_.white_paint : stock_.yellow_paint);
      const float dash = kind == 0 ? 1.0F : 3.0F, gap = kind == 0 ? 0.0F : Draw(random, 3, 5);
      for (; s < end; s += dash + gap) {
        if (kind == 2) {
          Strip(s, s + dash, 0.08F, 0.19F, 0.006F);
          Strip(s, s + dash, -0.19F, -0.08F, 0.006F);
        } else {
          Strip(s, s + dash, -0.06F, 0.06F, 0.006F);
        }
      }
      if (random.Uniform() < 0.6) {
        build_.Use(stock_.white_paint);
        for (float e = end - 40; e < end; e += 1) {
          const auto& a = PointStation(e);
          Strip(e, e + 1, a.half_left - 0.30F, a.half_left - 0.18F, 0.006F);
          Strip(e, e + 1, -a.half_right + 0.18F, -a.half_right + 0.30F, 0.006F);
        }
      }
    }
    build_.Use(stock_.white_paint);  // bays
    for (std::size_t i = 0; i < street_.stations.size(); i += 5) {
      const auto& a = Station(i);
      const float s = static_cast<float>(i);
      if (a.bay_left > 0) Strip(s, s + 0.12F, a.half_left, a.edge_left() - 0.1F, 0.006F);
      if (a.bay_right > 0) Strip(s, s + 0.12F, -a.edge_right() + 0.1F, -a.half_right, 0.006F);
    }
  }

  const Street::Station& PointStation(float s) const {
    const auto n = static_cast<std::ptrdiff_t>(street_.stations.size());
    const auto i = static_cast<std::ptrdiff_t>(s);
    return street_.stations[static_cast<std::size_t>(
        street_.closed ? ((i % n) + n) % n : std::clamp<std::ptrdiff_t>(i, 0, n - 1))];
  }

  // Patches of other tar, tar lines over cracks, manholes, drains: most of them for good, some
  // newly made between days.
  void Mend() {
    const auto count = static_cast<std::uint64_t>(street_.length() / 4);
    for (std::uint64_t k = 0; k < count; ++k) {
      const std::uint64_t id = SubSeed(SubSeed(seed_, 4), k);
      Random random(SubSeed(id, static_cast<std::uint64_t>(day_.Changes(id, 0.15))));
      const float s = 4 * static_cast<float>(k) + Draw(random, 0, 4);
      const float room = std::min(PointStation(s).half_left, PointStation(s).half_right) - 0.5F;
      const float side = Draw(random, -room, room);
      const double kind = random.Uniform();
      if (kind < 0.3) {
        build_.Use(world_.palette.Add({.picture = Picture::kAsphalt,
                                       .tint = Color::Constant(Draw(random, 0.45, 1.9)),
                                       .tile = 3,
                                       .ground = true}));
        const float half = Draw(random, 0.3, 1.2);
        Strip(s, s + Draw(random, 0.6, 4), std::max(-room, side - half),
              std::min(room, side + half), 0.003F);
      } else if (kind < 0.5) {
        build_.Use(stock_.rubber);
        float x = side;
        for (float t = s; t < s + 6; t += 0.7F) {
          const float next = std::clamp(x + Draw(random, -0.35, 0.35), -room, room);
          build_.Quad(At(t, x - 0.03F, 0.004F), At(t + 0.7F, next - 0.03F, 0.004F),
                      At(t + 0.7F, next + 0.03F, 0.004F), At(t, x + 0.03F, 0.004F));
          x = next;
        }
      } else if (kind < 0.62) {
        build_.Use(stock_.manhole);
        std::vector<Vec3> rim;
        for (int i = 0; i < 12; ++i) {
          const float a = static_cast<float>(i) * 0.5236F;
          rim.push_back(At(s, side, 0.008F) + Vec3(0.33F * std::cos(a), 0.33F * std::sin(a), 0));
        }
        build_.Polygon(rim);
      }
    }
  }

  void AddCrossings() {
    Random random(SubSeed(seed_, 5));
    for (float s = Draw(random, 20, 60); s < street_.length() - 10; s += Draw(random, 55, 170)) {
      const auto& a = PointStation(s);
      build_.Use(stock_.white_paint);
      if (random.Uniform() < 0.6) {
        for (float side = -a.half_right + 0.3F; side < a.half_left - 0.5F; side += 0.95F) {
          Strip(s, s + 3.2F, side, side + 0.48F, 0.007F);
        }
        Strip(s - 1.6F, s - 1.2F, -a.half_right + 0.2F, -0.2F, 0.007F);
      } else {  // a speed bump with slanted stripes
        for (int i = 0; i < 6; ++i) {
          const float t = s + 0.35F * static_cast<float>(i), z = 0.07F, lift = i < 3 ? 0 : z;
          build_.Use(i % 2 == 0 ? stock_.yellow_paint : stock_.black);
          const float z0 =
              i < 3 ? z * static_cast<float>(i) / 3 : lift * static_cast<float>(6 - i) / 3;
          const float z1 =
              i < 3 ? z * static_cast<float>(i + 1) / 3 : lift * static_cast<float>(5 - i) / 3;
          build_.Quad(At(t, -a.half_right, z0 + 0.01F), At(t + 0.35F, -a.half_right, z1 + 0.01F),
                      At(t + 0.35F, a.half_left, z1 + 0.01F), At(t, a.half_left, z0 + 0.01F));
        }
      }
    }
  }

  const Street& street_;
  const Site& site_;
  const Day& day_;
  std::uint64_t seed_;
  const Stock& stock_;
  World& world_;
  MeshBuilder build_;
};

}  // namespace

float VergeWidth(const Street& street, std::uint64_t street_seed, float s, bool left) {
  const auto width = [&](float piece) {
    const auto count = std::ceil(street.length() / kVergeStretch);
    const auto key = static_cast<std::uint64_t>(street.closed ? std::fmod(piece, count) : piece);
    return 1.5F +
           2.3F * static_cast<float>(SubSeed(SubSeed(street_seed, 6), key * 2 + left) % 997) / 997;
  };
  const float piece = std::floor(s / kVergeStretch), into = s - piece * kVergeStretch;
  const float t = SmoothStep(kVergeStretch - 6, kVergeStretch, into);
  return width(piece) * (1 - t) + width(piece + 1) * t;
}

void BuildRoads(const std::vector<Street>& streets, const Site& site, const Day& day,
                std::uint64_t seed, const Stock& stock, World& world) {
  for (std::size_t i = 0; i < streets.size(); ++i) {
    RoadLayer(streets[i], site, day, SubSeed(seed, i), stock, world).Lay();
  }
}

}  // namespace recollect::simulation
