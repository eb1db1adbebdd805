#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "recollect/wnn/displaced_patterns.h"
#include "recollect/wnn/network.h"

namespace recollect {
class ThreadPool;
}

namespace recollect::wnn {

// Patterns that change less with light and viewpoint than the reference's: of images scaled down,
// with local contrast normalised, in opponent colours, by other cells (see NetworkOptions).
class InvariantEncoder {
 public:
  // Whether the options ask for anything that the reference's encoder does not have.
  static bool Wanted(const NetworkOptions& options);

  // Sizes in pixels, of the whole image. `pool` must outlive it.
  InvariantEncoder(const NetworkOptions& options, int image_width, int image_height,
                   ThreadPool& pool);

  // Prepares an image of 8-bit gray or B, G, R for Encode with displacements of up to `reach`
  // either way.
  void Look(const cv::Mat& image, Pixel reach = {});
  // The pattern of that image displaced by `shift`, pixels of the image as it was given; its
  // border is repeated where that leaves it. Writes neurons x kWords words.
  void Encode(Pixel shift, std::span<std::uint64_t> pattern) const;
  // Whether Read takes the place of Encode: cells are bits of one picture, which are read under
  // many shifts at a time.
  bool reads_bits() const { return options_.cells == Cells::kGradient; }
  // Where it looks under shifts, best ordered by y, then by x.
  BitRuns RunsUnder(std::span<const Pixel> shifts) const;
  // One neuron's patterns, [word][shift], or those of all, [neuron][word][shift].
  void Read(const BitRuns& runs, std::size_t neuron, std::span<std::uint64_t> words) const;
  std::vector<std::uint64_t> ReadAll(const BitRuns& runs) const;

 private:
  Pixel Working(Pixel shift) const;
  std::ptrdiff_t Moved(Pixel shift) const;  // in a plane, by a shift of the image
  void SetMargin(Pixel margin);
  void AddPlane(const cv::Mat& channel, double blur);
  void AddGradients(const cv::Mat& padded);

  NetworkOptions options_;
  ThreadPool& pool_;
  double scale_;                       // working pixels an image pixel
  double unit_;                        // working pixels a pixel of a 640 pixels wide image
  int arm_;                            // of gradients, working pixels
  int width_, height_;                 // of the window, working pixels
  Pixel margin_{-1, -1};               // the border repeated around it
  std::vector<Pixel> synapses_;        // neurons x kSynapses
  std::vector<int> plane_of_;          // the same
  std::vector<std::int32_t> offsets_;  // the same: where each looks in a plane, with its margin
  // [plane][row][column]: values or, for gradients, whether they rise to the right, and then down.
  std::vector<std::int32_t> values_;
  std::vector<std::uint8_t> rising_;
  std::vector<std::uint8_t> packed_;  // the same, eight a byte
};

}  // namespace recollect::wnn
