#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "recollect/wnn/displaced_patterns.h"
#include "recollect/wnn/network.h"

namespace recollect {
class ThreadPool;
}

namespace recollect::wnn {

// An image in someone else's memory: rows of 8-bit pixels, channels interleaved.
struct ImageView {
  const std::uint8_t* data = nullptr;
  int width = 0, height = 0;  // pixels
  int channels = 1;           // 1: gray; 3: blue, green, red
  std::ptrdiff_t stride = 0;  // bytes from one row to the next
};

// Turns images of one size into patterns. Bit i of a neuron is 1 where the value under synapse i
// is below that under synapse i + 1, the last compared with the first (Minchinton cells). Not to
// be shared between threads: it keeps its working memory, so only the first frame allocates.
class Encoder {
 public:
  // Throws Error on options out of range. `pool` must outlive the encoder.
  Encoder(const NetworkOptions& options, int image_width, int image_height, ThreadPool& pool);
  ~Encoder();
  Encoder(Encoder&&) noexcept;
  Encoder& operator=(Encoder&&) noexcept;

  const Synapses& synapses() const;
  Displacements displacements() const;
  Displacements closer_displacements() const;
  // By neuron, the part of the image that it lies in, row by row; empty: there are no parts.
  const std::vector<int>& parts() const;
  // Whether the displacements of these tell how much larger the scene looks (zoom.h).
  bool tells_growth() const;
  // 64-bit words of one image's pattern: neurons x 2, the bits of synapses 0..63 first.
  std::size_t pattern_words() const;

  // Writes pattern_words() words. Throws Error where the image's size or channels are not those
  // announced. shift: the image is looked at so many pixels right and down of its true place,
  // its border repeated where that leaves it.
  void Encode(const ImageView& image, std::span<std::uint64_t> pattern, Pixel shift = {});
  std::vector<std::uint64_t> Encode(const ImageView& image, Pixel shift = {});

  // The image under all displacements of a grid. The first is valid until the next call.
  DisplacedImage LookDisplaced(const ImageView& image, const Displacements& grid);
  DisplacedPatterns EncodeDisplaced(const ImageView& image, const Displacements& grid);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace recollect::wnn
