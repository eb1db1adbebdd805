#include <algorithm>
#include <cmath>
#include <numbers>

#include "recollect/core/random.h"
#include "recollect/simulation/noise.h"
#include "recollect/simulation/pictures.h"

namespace recollect::simulation {
namespace {

// A picture that leaves are laid onto, later ones over earlier ones; empty places stay
// transparent.
class Spray {
 public:
  explicit Spray(int size, std::uint64_t seed)
      : size_(size),
        random_(seed),
        texels_(static_cast<std::size_t>(size * size), Texel{Color::Zero(), 0}) {}

  Random& random() { return random_; }

  // A pointed leaf from (x, y) along `angle`; lengths as shares of the picture.
  void Leaf(double x, double y, double angle, double length, double width, const Color& color) {
    const double c = std::cos(angle), s = std::sin(angle), n = size_;
    const double reach = length + width;
    for (int j = Low(y - reach); j <= High(y + reach); ++j) {
      for (int i = Low(x - reach); i <= High(x + reach); ++i) {
        const double dx = (i + 0.5) / n - x, dy = (j + 0.5) / n - y;
        const double along = (dx * c + dy * s) / length, across = (dy * c - dx * s) / width;
        if (along < 0 || along > 1) continue;
        const double half = std::sin(std::numbers::pi * std::sqrt(along)) * 0.5;
        if (std::abs(across) > half) continue;
        const double rib = std::abs(across) < 0.08 ? 1.3 : 0.8 + 0.4 * (across > 0);
        texels_[static_cast<std::size_t>(j * size_ + i)] = {color * static_cast<float>(rib), 1};
      }
    }
  }

  Texture Done() {
    Color mean = Color::Zero();
    float count = 1e-6F;
    for (const Texel& t : texels_) mean += t.color * t.alpha, count += t.alpha;
    for (Texel& t : texels_) {
      if (t.alpha == 0) t.color = mean / count;
    }
    return {size_, texels_};
  }

 private:
  int Low(double v) const { return std::max(0, static_cast<int>(v * size_)); }
  int High(double v) const { return std::min(size_ - 1, static_cast<int>(v * size_) + 1); }

  int size_;
  Random random_;
  std::vector<Texel> texels_;
};

Color LeafGreen(Random& random) {
  const auto light = static_cast<float>(random.Uniform(0.4, 1.25));
  const auto warm = static_cast<float>(random.Uniform(0.75, 1.25));
  return Color(0.085F * warm, 0.135F, 0.03F) * light;
}

// Leaves all over a disc, thinning out towards its rim.
Texture Bunch(std::uint64_t seed, int leaves, double length, double width, bool drooping) {
  Spray spray(256, seed);
  Random& random = spray.random();
  for (int i = 0; i < leaves; ++i) {
    const double angle = random.Uniform(0, 2 * std::numbers::pi);
    const double radius = 0.42 * std::pow(random.Uniform(), 0.6);
    const double x = 0.5 + radius * std::cos(angle), y = 0.5 + radius * std::sin(angle);
    const double turn = drooping ? random.Uniform(-2.1, -1.0) : random.Uniform(0, 6.28);
    spray.Leaf(x, y, turn, length * random.Uniform(0.6, 1.2), width * random.Uniform(0.7, 1.2),
               LeafGreen(random));
  }
  return spray.Done();
}

Texture PalmFrond() {
  Spray spray(256, 71);
  Random& random = spray.random();
  for (int i = 0; i < 70; ++i) {
    const double y = 0.02 + 0.93 * i / 70.0, reach = 0.46 * std::sin(0.35 + 2.6 * y / 1.0);
    for (const double side : {-1.0, 1.0}) {
      spray.Leaf(0.5, y, std::numbers::pi / 2 - side * random.Uniform(0.8, 1.15),
                 std::max(0.08, reach), 0.022, LeafGreen(random));
    }
  }
  spray.Leaf(0.5, 0.0, std::numbers::pi / 2, 1.0, 0.03, Color(0.12F, 0.12F, 0.04F));
  return spray.Done();
}

Texture Blossom() {
  Spray spray(256, 73);
  Random& random = spray.random();
  for (int i = 0; i < 260; ++i) {
    const double angle = random.Uniform(0, 6.28), radius = 0.43 * std::sqrt(random.Uniform());
    const Color petal = Color::Constant(static_cast<float>(random.Uniform(0.25, 0.8)));
    spray.Leaf(0.5 + radius * std::cos(angle), 0.5 + radius * std::sin(angle),
               random.Uniform(0, 6.28), 0.07, 0.05,
               random.Uniform() < 0.15 ? LeafGreen(random) : petal);
  }
  return spray.Done();
}

Texture GrassTuft() {
  Spray spray(256, 79);
  Random& random = spray.random();
  for (int i = 0; i < 90; ++i) {
    spray.Leaf(random.Uniform(0.15, 0.85), 0.0, random.Uniform(1.1, 2.05),
               random.Uniform(0.4, 0.98), random.Uniform(0.015, 0.035), LeafGreen(random) * 1.2F);
  }
  return spray.Done();
}

Texel Bark(float u, float v) {
  const float ridges = Fbm(u * 24, v * 6, 6, 5, 201, 0.65F), moss = Fbm(u * 4, v * 4, 4, 5, 202);
  const float light = 0.35F + 1.1F * ridges;
  return {Color(0.15F - 0.03F * moss, 0.115F, 0.08F - 0.02F * moss) * light, 1};
}

Texel Forest(float u, float v) {
  const CellNoise crown = Cells(u * 18, v * 18, 18, 211);
  const float leaves = Fbm(u * 110, v * 110, 110, 3, 212, 0.7F);
  const float round = 1.15F - 0.95F * crown.nearest;
  const float tone = 0.6F + 0.7F * static_cast<float>(crown.id & 255) / 255.0F;
  const float warm = 0.8F + 0.5F * static_cast<float>((crown.id >> 8) & 255) / 255.0F;
  return {Color(0.05F * warm, 0.085F, 0.025F) * tone * round * (0.4F + 1.1F * leaves), 1};
}

Texel Hedge(float u, float v) {
  const CellNoise leaf = Cells(u * 42, v * 42, 42, 221);
  const float depth = Fbm(u * 12, v * 12, 12, 4, 222);
  const float tone = 0.4F + 0.9F * static_cast<float>(leaf.id & 255) / 255.0F;
  const float light = tone * (1.0F - 0.8F * leaf.nearest) * (0.3F + 1.3F * depth);
  return {Color(0.07F, 0.12F, 0.03F) * light * 1.3F, 1};
}

Texel WireMesh(float u, float v) {
  const float a = (u + v) * 8, b = (u - v) * 8;
  const float wire = std::min(std::abs(a - std::round(a)), std::abs(b - std::round(b)));
  return {Color(0.35F, 0.36F, 0.36F), wire < 0.09F ? 1.0F : 0.0F};
}

}  // namespace

Texture PaintPlant(Picture picture) {
  switch (picture) {
    case Picture::kBroadLeaves:
      return Bunch(61, 260, 0.17, 0.085, false);
    case Picture::kFineLeaves:
      return Bunch(62, 700, 0.09, 0.035, false);
    case Picture::kLongLeaves:
      return Bunch(63, 260, 0.26, 0.03, true);
    case Picture::kPalmFrond:
      return PalmFrond();
    case Picture::kBlossom:
      return Blossom();
    case Picture::kGrassTuft:
      return GrassTuft();
    case Picture::kBark:
      return Texture::Paint(256, Bark);
    case Picture::kForest:
      return Texture::Paint(512, Forest);
    case Picture::kHedge:
      return Texture::Paint(512, Hedge);
    default:
      return Texture::Paint(256, WireMesh);
  }
}

}  // namespace recollect::simulation
