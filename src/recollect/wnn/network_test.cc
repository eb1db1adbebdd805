#include "recollect/wnn/network.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <utility>

#include "recollect/core/error.h"

namespace recollect::wnn {
namespace {

TEST(Synapses, LookAtTheTopOfTheImageAsTheReferenceDoes) {
  const Synapses reference({}, 640, 480);
  EXPECT_EQ(reference.neurons(), 5184);
  EXPECT_EQ(reference.window_width(), 640);
  EXPECT_EQ(reference.window_height(), 364);
  EXPECT_EQ(Synapses({}, 160, 120).window_height(), 91);
  EXPECT_EQ(Synapses({}, 828, 250).window_height(), 250);  // wider than the window: all of it
}

TEST(Synapses, CentresLieOnTheGridAndEveryCellHasOneNeuron) {
  const Synapses synapses({}, 640, 480);
  std::set<std::pair<int, int>> cells;
  for (int n = 0; n < synapses.neurons(); ++n) {
    const Pixel cell = synapses.Cell(n), centre = synapses.Centre(n);
    cells.insert({cell.x, cell.y});
    EXPECT_EQ(centre.x, static_cast<int>((cell.x + 0.5) * 640 / 96));
    EXPECT_EQ(centre.y, static_cast<int>((cell.y + 0.5) * 364 / 54));
    EXPECT_EQ(synapses.Of(n)[64].x, centre.x);  // the first Gaussian one
    EXPECT_EQ(synapses.Of(n)[64].y, centre.y);
  }
  EXPECT_EQ(cells.size(), 5184u);
}

TEST(Synapses, OrderOfNeuronsIsRandomSoThatAPrefixIsAFairSample) {
  const Synapses synapses({}, 640, 480);
  double sum_x = 0, sum_y = 0;
  const int prefix = 400;
  for (int n = 0; n < prefix; ++n) {
    sum_x += synapses.Cell(n).x;
    sum_y += synapses.Cell(n).y;
  }
  EXPECT_NEAR(sum_x / prefix, 47.5, 4 * 27.7 / std::sqrt(prefix));
  EXPECT_NEAR(sum_y / prefix, 26.5, 4 * 15.6 / std::sqrt(prefix));
}

TEST(Synapses, HalfAreUniformAndHalfGaussian) {
  const Synapses synapses({}, 640, 480);
  double uniform_x = 0, uniform_xx = 0, gauss_x = 0, gauss_xx = 0, gauss_yy = 0;
  int uniform = 0, gauss = 0;
  for (int n = 0; n < synapses.neurons(); ++n) {
    const Pixel centre = synapses.Centre(n);
    const bool inner = centre.x > 150 && centre.x < 490 && centre.y > 150 && centre.y < 214;
    for (int i = 0; i < kSynapses; ++i) {
      const Pixel p = synapses.Of(n)[i];
      ASSERT_TRUE(p.x >= 0 && p.x < 640 && p.y >= 0 && p.y < 364);
      if (i < 64) {
        uniform_x += p.x;
        uniform_xx += p.x * p.x;
        ++uniform;
      } else if (i > 64 && inner) {  // far from the border nothing is redrawn
        const double dx = p.x - centre.x, dy = p.y - centre.y;
        gauss_x += dx;
        gauss_xx += dx * dx;
        gauss_yy += dy * dy;
        ++gauss;
      }
    }
  }
  const double mean = uniform_x / uniform;
  EXPECT_NEAR(mean, 319.5, 2.0);
  EXPECT_NEAR(std::sqrt(uniform_xx / uniform - mean * mean), 640 / std::sqrt(12), 2.0);
  EXPECT_NEAR(gauss_x / gauss, 0.0, 1.0);
  EXPECT_NEAR(std::sqrt(gauss_xx / gauss), 30.0, 0.5);
  EXPECT_NEAR(std::sqrt(gauss_yy / gauss), 30.0, 0.5);
}

TEST(Synapses, ScaleWithTheImageAndFollowTheSeed) {
  const Synapses large({}, 640, 480), small({}, 160, 120);
  NetworkOptions other;
  other.seed = 2;
  const Synapses reseeded(other, 640, 480);
  int same = 0;
  for (int n = 0; n < large.neurons(); ++n) {
    for (int i = 0; i < kSynapses; ++i) {
      const Pixel a = large.Of(n)[i], b = small.Of(n)[i], c = reseeded.Of(n)[i];
      ASSERT_LE(std::abs(a.x / 4 - b.x), 1);
      ASSERT_LE(std::abs(a.y / 4 - b.y), 1);
      same += a.x == c.x && a.y == c.y;
    }
  }
  EXPECT_LT(same, 5184 * 128 / 100);
}

TEST(Synapses, RefusesOptionsOutOfRange) {
  const auto refused = [](auto change, int width = 640, int height = 480) {
    NetworkOptions options;
    change(options);
    EXPECT_THROW(Synapses(options, width, height), Error);
  };
  refused([](NetworkOptions& o) { o.neurons_x = 0; });
  refused([](NetworkOptions& o) { o.neurons_y = -1; });
  refused([](NetworkOptions& o) { o.gaussian_synapses = 129; });
  refused([](NetworkOptions& o) { o.gaussian_sigma = 0; });
  refused([](NetworkOptions& o) { o.blur_sigma = -1; });
  refused([](NetworkOptions& o) { o.blur_size = 32; });
  refused([](NetworkOptions& o) { o.window_aspect = 0; });
  refused([](NetworkOptions&) {}, 7, 480);
  refused([](NetworkOptions&) {}, 640, 0);
}

}  // namespace
}  // namespace recollect::wnn
