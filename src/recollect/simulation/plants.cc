#include "recollect/simulation/plants.h"

#include <cmath>

namespace recollect::simulation {
namespace {

Vec3 OnSphere(Random& random) {
  const float z = Draw(random, -1, 1), angle = Draw(random, 0, 6.28318);
  const float r = std::sqrt(1 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

struct Shape {
  float trunk = 2.5F, trunk_radius = 0.18F;
  Vec3 crown = {2.6F, 2.6F, 2};  // half-axes
  int clumps = 7, cards = 90;
  float card = 1.3F;
  int leaves = 0;
};

class TreeMaker {
 public:
  TreeMaker(std::uint64_t seed, const Stock& stock, const Palette& palette)
      : random_(seed),
        stock_(stock),
        solid_(model_.solid, palette),
        leafy_(model_.cutout, palette) {}

  // A trunk that forks into limbs, each with a clump of leaves at its end.
  Model Tree(const Shape& shape) {
    solid_.Use(stock_.bark);
    leafy_.Use(shape.leaves);
    const Vec3 fork(Draw(random_, -0.3, 0.3), Draw(random_, -0.3, 0.3), shape.trunk);
    solid_.Tube({0, 0, -0.5F}, fork, shape.trunk_radius * 1.25F, shape.trunk_radius, 7, false);
    const Vec3 heart = fork + Vec3(0, 0, shape.crown.z() * 0.75F);
    for (int c = 0; c < shape.clumps; ++c) {
      Vec3 way = OnSphere(random_);
      if (c == 0) way = Vec3(0, 0, 0.6F);
      const Vec3 centre = heart + way.cwiseProduct(shape.crown) * Draw(random_, 0.45, 0.72);
      solid_.Tube(fork, centre, shape.trunk_radius * 0.55F, 0.03F, 5, false);
      const float size = shape.crown.minCoeff() * Draw(random_, 0.42, 0.62);
      for (int k = 0; k < shape.cards / shape.clumps; ++k) {
        const Vec3 at = centre + OnSphere(random_) * size * std::cbrt(Draw(random_, 0.2, 1));
        Leaves(at, heart, shape.crown, shape.card * Draw(random_, 0.75, 1.25));
      }
    }
    return std::move(model_);
  }

  Model Palm(float height) {
    solid_.Use(stock_.bark);
    leafy_.Use(stock_.palm_frond);
    Vec3 at(0, 0, -0.5F);
    const Vec2 lean(Draw(random_, -0.1, 0.1), Draw(random_, -0.1, 0.1));
    for (int i = 0; i < 5; ++i) {
      const Vec3 next = at + Vec3(lean.x() * static_cast<float>(i) * 0.4F,
                                  lean.y() * static_cast<float>(i) * 0.4F, (height + 0.5F) / 5);
      solid_.Tube(at, next, 0.17F, 0.15F, 7, false);
      at = next;
    }
    for (int i = 0; i < 22; ++i) {
      const float angle = static_cast<float>(i) * 2.4F;
      float rise = Draw(random_, -0.7, 0.9);
      const Vec3 out(std::cos(angle), std::sin(angle), 0), side(-out.y(), out.x(), 0);
      const float reach = Draw(random_, 1.9, 2.6), half = 0.55F;
      Vec3 p = at;
      for (int piece = 0; piece < 2; ++piece) {  // each frond bends down once
        const Vec3 q = p + (out * std::cos(rise) + Vec3::UnitZ() * std::sin(rise)) * reach / 2;
        const float w0 = piece == 0 ? half * 0.6F : half, w1 = piece == 0 ? half : half * 0.5F;
        leafy_.Openness(0.8F);
        leafy_.Card(p - side * w0, p + side * w0, q + side * w1, q - side * w1,
                    Vec3::UnitZ() + out * 0.4F);
        p = q;
        rise -= 0.9F;
      }
    }
    return std::move(model_);
  }

  Model Bush(float radius, float height, int leaves, int cards) {
    leafy_.Use(leaves);
    const Vec3 heart(0, 0, height * 0.4F), axes(radius, radius, height * 0.6F);
    for (int k = 0; k < cards; ++k) {
      const Vec3 at = heart + OnSphere(random_).cwiseProduct(axes) * Draw(random_, 0.5, 0.9);
      Leaves(at, heart, axes, radius * Draw(random_, 0.7, 1.1));
    }
    return std::move(model_);
  }

  Model Tuft() {
    leafy_.Use(stock_.grass_tuft);
    for (int i = 0; i < 4; ++i) {
      const float angle = Draw(random_, 0, 3.14), half = Draw(random_, 0.2, 0.4);
      const Vec3 along(half * std::cos(angle), half * std::sin(angle), 0);
      const Vec3 at(Draw(random_, -0.3, 0.3), Draw(random_, -0.3, 0.3), -0.03F),
          up(0, 0, Draw(random_, 0.25, 0.6));
      leafy_.Card(at - along, at + along, at + along + up, at - along + up, Vec3::UnitZ());
    }
    return std::move(model_);
  }

 private:
  // A card of leaves, lit as the place in the crown where it hangs.
  void Leaves(const Vec3& at, const Vec3& heart, const Vec3& crown, float size) {
    const Vec3 outward = (at - heart).cwiseQuotient(crown);
    const float depth = std::min(1.0F, outward.norm());
    leafy_.Openness(0.25F + 0.45F * depth * depth + 0.3F * std::max(0.0F, outward.z()));
    const Vec3 face = (OnSphere(random_) + outward.normalized() * 0.8F).normalized();
    Vec3 x = face.cross(OnSphere(random_)).normalized() * size / 2;
    const Vec3 y = face.cross(x);
    leafy_.Card(at - x - y, at + x - y, at + x + y, at - x + y,
                outward.normalized() + face * 0.35F + Vec3(0, 0, 0.2F));
  }

  Random random_;
  const Stock& stock_;
  Model model_;
  MeshBuilder solid_, leafy_;
};

}  // namespace

Plants::Plants(std::uint64_t seed, const Stock& stock, World& world) {
  std::uint64_t next = seed;
  const auto maker = [&] { return TreeMaker(next = Scramble(next), stock, world.palette); };
  Random random(SubSeed(seed, 9));
  for (int i = 0; i < 7; ++i) {
    broad.push_back(world.AddModel(
        maker().Tree({.trunk = Draw(random, 1.8, 3.2),
                      .trunk_radius = Draw(random, 0.14, 0.3),
                      .crown = {Draw(random, 2, 4), Draw(random, 2, 4), Draw(random, 1.6, 2.8)},
                      .clumps = 8,
                      .cards = 110,
                      .card = 1.5F,
                      .leaves = stock.broad_leaves})));
    fine.push_back(world.AddModel(maker().Tree(
        {.trunk = Draw(random, 2, 4),
         .trunk_radius = Draw(random, 0.12, 0.22),
         .crown = {Draw(random, 2.5, 4.5), Draw(random, 2.5, 4.5), Draw(random, 1.1, 2)},
         .clumps = 9,
         .cards = 110,
         .card = 1.6F,
         .leaves = stock.fine_leaves})));
  }
  for (int i = 0; i < 5; ++i) {
    tall.push_back(world.AddModel(maker().Tree(
        {.trunk = Draw(random, 5, 8),
         .trunk_radius = Draw(random, 0.2, 0.35),
         .crown = {Draw(random, 1.5, 2.4), Draw(random, 1.5, 2.4), Draw(random, 3, 4.5)},
         .clumps = 8,
         .cards = 100,
         .card = 1.5F,
         .leaves = stock.long_leaves})));
    palms.push_back(world.AddModel(maker().Palm(Draw(random, 3.5, 9))));
    flowering.push_back(world.AddModel(
        maker().Tree({.trunk = 2.2F,
                      .trunk_radius = 0.17F,
                      .crown = {Draw(random, 2, 3), Draw(random, 2, 3), Draw(random, 1.3, 2)},
                      .clumps = 7,
                      .cards = 90,
                      .card = 1.3F,
                      .leaves = stock.blossom})));
    bushes.push_back(
        world.AddModel(maker().Bush(Draw(random, 0.6, 1.2), Draw(random, 0.7, 1.9),
                                    i % 2 == 0 ? stock.broad_leaves : stock.fine_leaves, 34)));
    tufts.push_back(world.AddModel(maker().Tuft()));
  }
}

Color Plants::Tint(std::uint64_t id, const Day& day) {
  Random random(id);
  const float light = Draw(random, 0.65, 1.35), warm = Draw(random, 0.8, 1.35);
  const float thirst = Draw(random, 0, 1) * day.dryness;
  return Color(warm * (1 + 0.9F * thirst), 1 + 0.15F * thirst, Draw(random, 0.6, 1.3)) * light *
         (0.92F + 0.16F * static_cast<float>(day.Draw(77, !day.change.season)));
}

}  // namespace recollect::simulation
