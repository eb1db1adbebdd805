#include "recollect/wnn/network.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "recollect/core/error.h"
#include "recollect/core/random.h"

namespace recollect::wnn {
namespace {

constexpr double kReferenceWidth = 640;
constexpr int kMostColumns = 56;           // what one read of a word finds wherever it begins
constexpr std::uint64_t kOrderStream = 0;  // sub-streams of the seed
constexpr std::uint64_t kSynapseStream = 1;

void Check(const NetworkOptions& options, int width, int height) {
  const std::string where = "network";
  Require(options.neurons_x > 0 && options.neurons_y > 0 && options.neurons() <= 1 << 20, where,
          "the number of neurons must be 1 to 1048576", "set neurons_x and neurons_y");
  Require(options.gaussian_synapses >= 0 && options.gaussian_synapses <= kSynapses, where,
          "gaussian_synapses must be 0 to 128");
  Require(options.gaussian_sigma > 0 && options.blur_sigma > 0, where, "sigmas must be positive");
  Require(options.blur_size > 0 && options.blur_size % 2 == 1, where,
          "blur_size must be odd and positive");
  Require(options.window_aspect > 0, where, "window_aspect must be positive");
  Require(options.working_width >= 0 && options.contrast_sigma >= 0 && options.gradient_arm > 0 &&
              options.blur_scales >= 1 && options.blur_scales <= 4,
          where,
          "working_width and contrast_sigma must not be negative, gradient_arm positive, "
          "blur_scales 1 to 4");
  Require(options.parts_x >= 0 && options.parts_y >= 0 && options.parts_x <= 64 &&
              options.parts_y <= 64 && !options.parts_x == !options.parts_y,
          where, "parts_x and parts_y must be both 0, or both 1 to 64");
  DisplacementsOf(options);
  CloserDisplacementsOf(options);
  Require(width >= 8 && height >= 8 && width <= 1 << 14 && height <= 1 << 14, where,
          "images must be 8 to 16384 pixels a side");
}

std::vector<Pixel> ShuffledCells(const NetworkOptions& options) {
  std::vector<Pixel> cells;
  for (int y = 0; y < options.neurons_y; ++y) {
    for (int x = 0; x < options.neurons_x; ++x) cells.push_back({x, y});
  }
  Random random(SubSeed(options.seed, kOrderStream));
  for (std::size_t i = cells.size(); i > 1; --i) {
    std::swap(cells[i - 1], cells[static_cast<std::size_t>(random.Index(static_cast<int>(i)))]);
  }
  return cells;
}

}  // namespace

NetworkOptions RecollectNetwork() {
  NetworkOptions options;
  options.neurons_x = 32;
  options.neurons_y = 18;
  options.code = Code::kOpponent;
  options.cells = Cells::kGradient;
  options.gaussian_synapses = kSynapses;
  options.blur = false;
  options.working_width = 160;
  options.shift_x = 64;
  options.shift_y = 32;
  options.closer_step = 4;
  options.parts_x = 8;
  options.parts_y = 3;
  return options;
}

Displacements DisplacementsOf(const NetworkOptions& options) {
  Require(options.shift_x >= 0 && options.shift_y >= 0 && options.shift_step > 0 &&
              options.shift_x / options.shift_step <= 16 &&
              options.shift_y / options.shift_step <= 16,
          "network", "shift_x and shift_y must be 0 to 16 times shift_step");
  return {2 * (options.shift_x / options.shift_step) + 1,
          2 * (options.shift_y / options.shift_step) + 1, options.shift_step};
}

Displacements CloserDisplacementsOf(const NetworkOptions& options) {
  if (options.closer_step == 0) return {};
  Require(options.closer_step > 0 && options.shift_step % options.closer_step == 0 &&
              options.shift_step / options.closer_step <= 16,
          "network", "closer_step must divide shift_step, by 16 at most");
  const Displacements coarse = DisplacementsOf(options);
  const int finer = options.shift_step / options.closer_step;
  Require((coarse.columns - 1) * finer < kMostColumns, "network",
          "closer_step must go 27 times into shift_x at most");
  return {(coarse.columns - 1) * finer + 1, (coarse.rows - 1) * finer + 1, options.closer_step};
}

Synapses::Synapses(const NetworkOptions& options, int image_width, int image_height) {
  Check(options, image_width, image_height);
  neurons_x_ = options.neurons_x;
  width_ = image_width;
  height_ =
      std::min(image_height, static_cast<int>(std::lround(image_width * options.window_aspect)));
  step_x_ = static_cast<double>(width_) / options.neurons_x;
  step_y_ = static_cast<double>(height_) / options.neurons_y;
  grid_ = ShuffledCells(options);

  const double sigma = options.gaussian_sigma * width_ / kReferenceWidth;
  const std::uint64_t seed = SubSeed(options.seed, kSynapseStream);
  const int uniform = kSynapses - options.gaussian_synapses;
  pixels_.reserve(grid_.size() * kSynapses);
  for (const Pixel cell : grid_) {
    const double centre_x = (cell.x + 0.5) * step_x_, centre_y = (cell.y + 0.5) * step_y_;
    // The stream belongs to the cell: the order of neurons does not move a synapse.
    Random random(SubSeed(seed, static_cast<std::uint64_t>(cell.y * options.neurons_x + cell.x)));
    for (int i = 0; i < kSynapses; ++i) {
      double x = centre_x, y = centre_y;
      if (i < uniform) {
        x = random.Uniform() * width_;
        y = random.Uniform() * height_;
      } else if (i > uniform) {
        do {
          x = centre_x + sigma * random.Normal();
          y = centre_y + sigma * random.Normal();
        } while (x < 0 || x >= width_ || y < 0 || y >= height_);
      }
      pixels_.push_back({static_cast<int>(x), static_cast<int>(y)});
    }
  }
}

Pixel Synapses::Centre(int neuron) const {
  const Pixel cell = Cell(neuron);
  return {static_cast<int>((cell.x + 0.5) * step_x_), static_cast<int>((cell.y + 0.5) * step_y_)};
}

}  // namespace recollect::wnn
