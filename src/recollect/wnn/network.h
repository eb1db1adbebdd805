#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace recollect::wnn {

// Bits of one neuron's pattern, one a synapse, and the 64-bit words that hold them.
inline constexpr int kSynapses = 128;
inline constexpr int kWords = 2;

// How a pixel becomes the one number that synapses compare. kColour: R + 256 G + 65536 B, so blue
// decides, as the reference does. kGray: luma. On gray images both order pixels alike. kOpponent: a
// third of a neuron's synapses each reads luma, red against blue, and green against both, so that
// hue counts beside brightness and none of them decides alone.
enum class Code { kColour, kGray, kOpponent };

// What a bit says of the value v under its synapse. kCompare: v is below the next synapse's
// (Minchinton). kGradient: v rises to the right (even synapses) or down (odd ones). kRank: v is
// above the median of its neuron's synapses.
enum class Cells { kCompare, kGradient, kRank };

// The VG-RAM network (Forechi et al. 2018, section III-A). Lengths in pixels are those of a
// 640 pixels wide image and scale with the width; the defaults are the reference's network.
struct NetworkOptions {
  int neurons_x = 96;  // columns and rows of neurons, spread evenly over the window
  int neurons_y = 54;
  Code code = Code::kColour;
  double window_aspect = 364.0 / 640;  // rows looked at: the top width * this, or all if fewer
  int gaussian_synapses = 64;  // of the 128, around the neuron's centre; the rest lie anywhere
  double gaussian_sigma = 30;  // spread of those, pixels per axis
  bool blur = true;            // the Gaussian ones read a blurred copy of the image
  double blur_sigma = 11;      // of that copy; pixels
  int blur_size = 33;          // side of the blurring kernel; pixels
  std::uint64_t seed = 1;      // of the synapses and of the order of neurons

  // Beyond the reference, see docs/recognition.md; all of it off by default.
  Cells cells = Cells::kCompare;
  int working_width = 0;      // wider images are scaled down to it first; 0: none are
  double contrast_sigma = 0;  // local contrast normalisation over so wide a surrounding; 0: none
  double gradient_arm = 12;   // of kGradient: pixels from the synapse to either end
  int blur_scales = 1;        // blurred copies; each is blurred twice as much as the one before
  // A live image is looked at under displacements of up to so many pixels either way, one every
  // shift_step; 0: only as it is.
  int shift_x = 0, shift_y = 0;
  int shift_step = 16;
  // The best places are looked at again, under displacements of the same reach but one every so
  // many pixels, a divisor of shift_step (closer_look.h); 0: they are not.
  int closer_step = 0;
  // There the image is also cut into so many columns and rows of parts, each of which may be
  // displaced in its own way; 0: it is not.
  int parts_x = 0, parts_y = 0;
  bool growth = true;  // and their displacements tell how much larger the scene looks (zoom.h)

  int neurons() const { return neurons_x * neurons_y; }
};

// The configuration that this project recommends, chosen as docs/recognition.md tells.
NetworkOptions RecollectNetwork();

// The displacements of live images: rows of a grid, all of one length, in pixels of a 640 pixels
// wide image. {0, 0} alone where the options ask for none. Throws Error on options out of range.
struct Displacements {
  int columns = 1, rows = 1;
  int step = 0;  // from one to the next

  int count() const { return columns * rows; }
};
Displacements DisplacementsOf(const NetworkOptions& options);
// Those of the second look; {0, 0} alone where there is none.
Displacements CloserDisplacementsOf(const NetworkOptions& options);

// A pixel of the window.
struct Pixel {
  int x = 0, y = 0;
};

// Where the network's synapses lie in images of one size. Neurons are numbered in a random order
// drawn from the seed, not by position: any first n of them are then a fair sample of the whole
// committee, which is what searches that stop early rest on.
class Synapses {
 public:
  // Sizes in pixels. Throws Error on options out of range or an image under 8 x 8.
  Synapses(const NetworkOptions& options, int image_width, int image_height);

  int neurons() const { return static_cast<int>(grid_.size()); }
  int neurons_x() const { return neurons_x_; }  // columns and rows of the grid
  int neurons_y() const { return neurons() / neurons_x_; }
  int window_width() const { return width_; }  // the top rows of the image that are looked at
  int window_height() const { return height_; }

  // Cell of the neuron grid, x in [0, neurons_x), y in [0, neurons_y), and its centre's pixel.
  Pixel Cell(int neuron) const { return grid_[static_cast<std::size_t>(neuron)]; }
  Pixel Centre(int neuron) const;

  // The neuron's 128 pixels: uniform ones first, then the Gaussian ones, its centre their first.
  const Pixel* Of(int neuron) const {
    return &pixels_[static_cast<std::size_t>(neuron) * kSynapses];
  }

 private:
  int neurons_x_;
  int width_, height_;
  double step_x_, step_y_;     // window pixels a neuron
  std::vector<Pixel> grid_;    // by neuron
  std::vector<Pixel> pixels_;  // neurons x kSynapses
};

}  // namespace recollect::wnn
