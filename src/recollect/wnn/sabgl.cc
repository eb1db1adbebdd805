#include "recollect/wnn/sabgl.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"

namespace recollect::wnn {

Sabgl::Sabgl(int length, const Route& route)
    : length_(static_cast<std::size_t>(length)), route_(route) {
  std::vector<bool> seen(route.next.size(), false);
  const auto follow = [&](int place) {
    for (; place >= 0 && !seen[static_cast<std::size_t>(place)];
         place = route.next[static_cast<std::size_t>(place)]) {
      seen[static_cast<std::size_t>(place)] = true;
      order_.push_back(place);
    }
  };
  for (int place = 0; place < route.places(); ++place) {
    if (route.before[static_cast<std::size_t>(place)] < 0) follow(place);
  }
  for (int place = 0; place < route.places(); ++place) follow(place);  // closed loops
}

int Sabgl::EndOf(std::size_t length) const {
  const std::size_t first = distances_.size() - length;
  std::vector<float> cost = distances_[first], next(cost.size());
  for (std::size_t image = first + 1; image < distances_.size(); ++image) {
    for (const int place : order_) {
      const auto j = static_cast<std::size_t>(place);
      float best = cost[j];
      if (route_.before[j] >= 0) {
        const auto before = static_cast<std::size_t>(route_.before[j]);
        best = std::min({best, cost[before],
                         // Not yet known where a loop closes on its first place.
                         place == order_.front() ? cost[before] : next[before]});
      }
      next[j] = distances_[image][j] + best;
    }
    std::swap(cost, next);
  }
  return static_cast<int>(std::min_element(cost.begin(), cost.end()) - cost.begin());
}

std::vector<double> Sabgl::Update(const Observation& observation) {
  Require(observation.distances.size() == route_.next.size(), "SABGL",
          "needs the mean distance to every place");
  distances_.emplace_back(observation.distances.begin(), observation.distances.end());
  if (distances_.size() > length_) distances_.pop_front();
  std::vector<double> belief(route_.next.size(), 0);
  for (std::size_t length = 1; length <= distances_.size(); ++length) {
    belief[static_cast<std::size_t>(EndOf(length))] += 1.0 / static_cast<double>(distances_.size());
  }
  return belief;
}

std::vector<float> MeanDistances(const Memory& memory, std::span<const std::uint64_t> pattern,
                                 ThreadPool& pool) {
  const auto neurons = static_cast<std::size_t>(memory.neurons());
  Require(pattern.size() == neurons * kWords, "pattern", "is of another network");
  std::vector<float> mean(static_cast<std::size_t>(memory.entries()));
  const auto blocks = static_cast<std::int64_t>(memory.blocks().size());
  pool.For(blocks, 1, [&](std::int64_t begin, std::int64_t end) {
    for (auto b = static_cast<std::size_t>(begin); b < static_cast<std::size_t>(end); ++b) {
      const BlockView& block = memory.blocks()[b];
      const auto capacity = static_cast<std::size_t>(block.capacity);
      std::vector<std::int64_t> sums(capacity, 0);
      for (std::size_t n = 0; n < neurons; ++n) {
        const std::uint64_t* low = block.words + n * capacity;
        const std::uint64_t* high = low + neurons * capacity;
        for (std::size_t f = 0; f < capacity; ++f) {
          sums[f] += std::popcount(low[f] ^ pattern[n * kWords]) +
                     std::popcount(high[f] ^ pattern[n * kWords + 1]);
        }
      }
      for (int f = 0; f < block.frames; ++f) {
        mean[static_cast<std::size_t>(memory.first_entry(b) + f)] = static_cast<float>(
            static_cast<double>(sums[static_cast<std::size_t>(f)]) / static_cast<double>(neurons));
      }
    }
  });
  return mean;
}

std::vector<float> DisplacedDistances(const Memory& memory, Encoder& encoder,
                                      const ImageView& image, ThreadPool& pool) {
  const Displacements grid = encoder.displacements();
  const DisplacedPatterns live = encoder.EncodeDisplaced(image, grid);
  std::vector<float> least = MeanDistances(memory, live.Under(0), pool);
  for (int d = 1; d < grid.count(); ++d) {
    const std::vector<float> other = MeanDistances(memory, live.Under(d), pool);
    for (std::size_t i = 0; i < least.size(); ++i) least[i] = std::min(least[i], other[i]);
  }
  return least;
}

}  // namespace recollect::wnn
