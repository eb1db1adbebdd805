#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "recollect/wnn/network.h"

namespace recollect::wnn {

class InvariantEncoder;

// One image's patterns under all displacements of a grid, which are numbered row by row.
struct DisplacedPatterns {
  Displacements grid;
  std::vector<std::uint64_t> words;  // [neuron][word][displacement]

  // A neuron's words: by displacement, the first ones before the second ones.
  std::span<const std::uint64_t> Of(std::size_t neuron) const {
    const std::size_t count = kWords * static_cast<std::size_t>(grid.count());
    return std::span(words).subspan(neuron * count, count);
  }
  // The pattern under one displacement, neurons x kWords words.
  std::vector<std::uint64_t> Under(int displacement) const;
};

// Where a picture of packed bits is read: runs of displacements that one read of a word takes in.
struct BitRuns {
  struct Run {
    std::ptrdiff_t moved;  // by the first of them, in packed bits
    int begin, end;        // their numbers
    int reach;             // bits from the first to behind the last
  };
  std::vector<std::ptrdiff_t> moved;  // by displacement
  std::vector<Run> runs;
};
BitRuns RunsOf(std::vector<std::ptrdiff_t> moved);

// An image under all displacements of a grid. Patterns under hundreds of them are more than caches
// hold, so those that can be read from one picture are read when they are asked for, neuron by
// neuron. Valid until its encoder sees the next image.
class DisplacedImage {
 public:
  DisplacedImage(const InvariantEncoder& picture, const Displacements& grid, BitRuns runs);
  explicit DisplacedImage(DisplacedPatterns patterns);

  const Displacements& grid() const { return patterns_.grid; }
  // As DisplacedPatterns::Of; they may lie in `room`.
  std::span<const std::uint64_t> Of(std::size_t neuron, std::vector<std::uint64_t>& room) const;
  // Under every so many-th displacement either way, from the first of a row and column on.
  DisplacedPatterns Every(int steps) const;

 private:
  const InvariantEncoder* picture_ = nullptr;  // null: all is in patterns_
  BitRuns runs_;
  DisplacedPatterns patterns_;
};

}  // namespace recollect::wnn
