#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace recollect::wnn {

// Bits of one neuron's pattern, one a synapse, and the 64-bit words that hold them.
inline constexpr int kSynapses = 128;
inline constexpr int kWords = 2;

// How a pixel becomes the one number that synapses compare. kColour: R + 256 G + 65536 B, so blue
// decides, as the reference does. kGray: luma. On gray images both order pixels alike.
enum class Code { kColour, kGray };

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

  int neurons() const { return neurons_x * neurons_y; }
};

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
  int width_, height_;
  double step_x_, step_y_;     // window pixels a neuron
  std::vector<Pixel> grid_;    // by neuron
  std::vector<Pixel> pixels_;  // neurons x kSynapses
};

}  // namespace recollect::wnn
