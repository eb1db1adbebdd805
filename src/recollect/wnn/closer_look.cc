#include "recollect/wnn/closer_look.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "recollect/core/parallel.h"
#include "recollect/wnn/kernel.h"

namespace recollect::wnn {
namespace {

constexpr int kGrain = 16;  // neurons that a thread takes at a time

NeuronViews ViewsOf(const DisplacedPatterns& live, std::size_t neuron) {
  return {live.Of(neuron, 0).data(), live.Of(neuron, 1).data(), live.grid.count()};
}

std::vector<std::vector<std::uint64_t>> PatternsOf(const Memory& memory,
                                                   std::span<const int> entries) {
  std::vector<std::vector<std::uint64_t>> patterns;
  for (const int entry : entries) patterns.push_back(memory.Pattern(entry));
  return patterns;
}

// One number a displacement, with a border of one all around, so that neighbours are found without
// asking where the grid ends.
struct Bordered {
  explicit Bordered(const Displacements& grid)
      : columns(grid.columns),
        rows(grid.rows),
        stride(grid.columns + 2),
        from(stride + 1),
        to(stride * (grid.rows + 1) - 1),
        size(static_cast<std::size_t>(stride * (grid.rows + 2))) {}
  int At(int displacement) const {
    return from + displacement / columns * stride + displacement % columns;
  }
  int Displacement(int at) const { return (at - from) / stride * columns + (at - from) % stride; }
  // The displacement of the greatest number, of equals the first.
  int Greatest(const std::uint16_t* numbers) const {
    int best = from;
    for (int row = 0; row < rows; ++row) {
      const std::uint16_t* first = numbers + from + row * stride;
      const auto greatest = static_cast<int>(std::max_element(first, first + columns) - numbers);
      if (numbers[greatest] > numbers[best]) best = greatest;
    }
    return Displacement(best);
  }

  int columns, rows, stride, from, to;
  std::size_t size;
};

// Where one neuron is near an entry, and what it gives for that.
class Voter {
 public:
  explicit Voter(const Displacements& grid)
      : grid_(grid),
        flat_(static_cast<std::size_t>(grid.count())),
        near_(grid_.size),
        scratch_(grid_.size) {}

  void Vote(const NeuronViews& views, const std::uint64_t* entry, int limit, std::uint16_t* votes) {
    if (!kernel_.find_near(views, entry, limit, flat_.data())) return;
    for (int row = 0; row < grid_.rows; ++row) {
      std::copy_n(flat_.begin() + row * grid_.columns, grid_.columns,
                  near_.begin() + grid_.from + row * grid_.stride);
    }
    kernel_.spread_votes(near_.data(), grid_.stride, grid_.from, grid_.to, scratch_.data(), votes);
  }

 private:
  const Kernel& kernel_ = *Kernels().front();
  Bordered grid_;
  std::vector<std::uint8_t> flat_, near_, scratch_;
};

// Neurons by part; by their number, some at a time, where there are no parts.
std::vector<std::vector<std::size_t>> Sorted(std::span<const int> parts, std::size_t neurons) {
  std::vector<std::vector<std::size_t>> sorted;
  for (std::size_t n = 0; n < neurons; ++n) {
    const std::size_t part = parts.empty() ? n / kGrain : static_cast<std::size_t>(parts[n]);
    if (part >= sorted.size()) sorted.resize(part + 1);
    sorted[part].push_back(n);
  }
  return sorted;
}

}  // namespace

std::vector<int> NearDistances(const Memory& memory, const DisplacedPatterns& live,
                               std::span<const int> displacements, std::span<const int> usual,
                               ThreadPool& pool) {
  const auto entries = PatternsOf(memory, usual);
  std::vector<int> near(static_cast<std::size_t>(memory.neurons()), -1);
  if (entries.empty()) return near;
  const Kernel& kernel = *Kernels().front();
  const std::size_t seen = displacements.size();
  pool.For(memory.neurons(), kGrain, [&](std::int64_t begin, std::int64_t end) {
    std::vector<std::uint64_t> low(seen), high(seen);
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) {
      const auto all_low = live.Of(n, 0), all_high = live.Of(n, 1);
      for (std::size_t d = 0; d < seen; ++d) {
        low[d] = all_low[static_cast<std::size_t>(displacements[d])];
        high[d] = all_high[static_cast<std::size_t>(displacements[d])];
      }
      const NeuronViews views{low.data(), high.data(), static_cast<int>(seen)};
      std::uint64_t sum = 0, squares = 0;
      for (const auto& entry : entries) {
        kernel.add_distances(views, &entry[kWords * n], sum, squares);
      }
      const auto count = static_cast<double>(seen * entries.size());
      const double mean = static_cast<double>(sum) / count;
      const double variance = static_cast<double>(squares) / count - mean * mean;
      // A neuron to which all entries look alike is of no use below one bit of spread.
      const double limit = mean - kNearDeviations * std::sqrt(std::max(1.0, variance));
      near[n] = std::max(-1, static_cast<int>(std::floor(limit)));
    }
  });
  return near;
}

std::vector<Look> LookCloser(const Memory& memory, const DisplacedPatterns& live,
                             std::span<const int> near, std::span<const int> entries,
                             std::span<const int> parts, ThreadPool& pool) {
  const auto stored = PatternsOf(memory, entries);
  const auto neurons = Sorted(parts, near.size());
  const Bordered grid(live.grid);
  std::vector<Look> looks(entries.size());
  for (Look& look : looks) look.displacements.resize(parts.empty() ? 1 : 1 + neurons.size());
  std::vector<std::uint16_t> whole(entries.size() * grid.size, 0);
  std::mutex adding;
  pool.For(static_cast<std::int64_t>(neurons.size()), 1, [&](std::int64_t begin, std::int64_t end) {
    Voter voter(live.grid);
    std::vector<std::uint16_t> votes(whole.size());
    for (auto part = static_cast<std::size_t>(begin); part < static_cast<std::size_t>(end);
         ++part) {
      std::fill(votes.begin(), votes.end(), std::uint16_t{0});
      for (const std::size_t n : neurons[part]) {
        if (near[n] < 0) continue;
        const NeuronViews views = ViewsOf(live, n);
        for (std::size_t e = 0; e < stored.size(); ++e) {
          voter.Vote(views, &stored[e][kWords * n], near[n], &votes[e * grid.size]);
        }
      }
      const std::lock_guard lock(adding);
      for (std::size_t i = 0; i < whole.size(); ++i) {
        whole[i] = static_cast<std::uint16_t>(whole[i] + votes[i]);
      }
      for (std::size_t e = 0; e < stored.size() && !parts.empty(); ++e) {
        const std::uint16_t* own = &votes[e * grid.size];
        const int best = grid.Greatest(own);
        looks[e].displacements[1 + part] = best;
        looks[e].halves += own[grid.At(best)];
      }
    }
  });
  for (std::size_t e = 0; e < stored.size(); ++e) {
    const std::uint16_t* all = &whole[e * grid.size];
    const int best = grid.Greatest(all);
    looks[e].displacements[0] = best;
    looks[e].halves += (parts.empty() ? 2 : 1) * all[grid.At(best)];
  }
  return looks;
}

std::vector<int> HalvesOf(const Memory& memory, const DisplacedPatterns& live,
                          std::span<const int> near, int entry, std::span<const int> parts,
                          std::span<const int> displacements) {
  const std::vector<std::uint64_t> stored = memory.Pattern(entry);
  const Bordered grid(live.grid);
  Voter voter(live.grid);
  std::vector<int> halves;
  for (std::size_t n = 0; n < near.size(); ++n) {
    std::vector<std::uint16_t> votes(grid.size, 0);
    if (near[n] >= 0) voter.Vote(ViewsOf(live, n), &stored[kWords * n], near[n], votes.data());
    const auto under = [&](std::size_t which) {
      return static_cast<int>(votes[static_cast<std::size_t>(grid.At(displacements[which]))]);
    };
    halves.push_back(parts.empty() ? 2 * under(0)
                                   : under(0) + under(1 + static_cast<std::size_t>(parts[n])));
  }
  return halves;
}

}  // namespace recollect::wnn
