#include "recollect/wnn/displaced_patterns.h"

#include <algorithm>
#include <utility>

#include "recollect/wnn/bit_square.h"
#include "recollect/wnn/invariant.h"

namespace recollect::wnn {

std::vector<std::uint64_t> DisplacedPatterns::Under(int displacement) const {
  const auto count = static_cast<std::size_t>(grid.count());
  std::vector<std::uint64_t> pattern(words.size() / count);
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    pattern[i] = words[i * count + static_cast<std::size_t>(displacement)];
  }
  return pattern;
}

BitRuns RunsOf(std::vector<std::ptrdiff_t> moved) {
  std::vector<BitRuns::Run> runs;
  for (int i = 0; i < static_cast<int>(moved.size()); ++i) {
    const std::ptrdiff_t at = moved[static_cast<std::size_t>(i)];
    const bool within = !runs.empty() && at >= runs.back().moved && at - runs.back().moved < kReach;
    if (!within) runs.push_back({at, i, i, 0});
    BitRuns::Run& run = runs.back();
    run.end = i + 1;
    run.reach = std::max(run.reach, static_cast<int>(at - run.moved) + 1);
  }
  return {std::move(moved), std::move(runs)};
}

DisplacedImage::DisplacedImage(const InvariantEncoder& picture, const Displacements& grid,
                               BitRuns runs)
    : picture_(&picture), runs_(std::move(runs)), patterns_{grid, {}} {}

DisplacedImage::DisplacedImage(DisplacedPatterns patterns) : patterns_(std::move(patterns)) {}

std::span<const std::uint64_t> DisplacedImage::Of(std::size_t neuron,
                                                  std::vector<std::uint64_t>& room) const {
  if (!picture_) return patterns_.Of(neuron);
  room.resize(kWords * static_cast<std::size_t>(grid().count()));
  picture_->Read(runs_, neuron, room);
  return room;
}

DisplacedPatterns DisplacedImage::Every(int steps) const {
  DisplacedPatterns some;
  some.grid = {(grid().columns - 1) / steps + 1, (grid().rows - 1) / steps + 1,
               grid().step * steps};
  std::vector<std::size_t> kept;
  for (int y = 0; y < grid().rows; y += steps) {
    for (int x = 0; x < grid().columns; x += steps) {
      kept.push_back(static_cast<std::size_t>(y * grid().columns + x));
    }
  }
  if (picture_) {
    std::vector<std::ptrdiff_t> moved;
    for (const std::size_t d : kept) moved.push_back(runs_.moved[d]);
    some.words = picture_->ReadAll(RunsOf(std::move(moved)));
    return some;
  }
  const auto count = static_cast<std::size_t>(grid().count());
  for (std::size_t row = 0; row < patterns_.words.size(); row += count) {
    for (const std::size_t d : kept) some.words.push_back(patterns_.words[row + d]);
  }
  return some;
}

}  // namespace recollect::wnn
