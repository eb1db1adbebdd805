#include "recollect/wnn/closer_look.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "recollect/core/parallel.h"

namespace recollect::wnn {
namespace {

constexpr int kGrain = 16;  // neurons that a thread takes at a time

// Compiled for machines that count bits in vectors, in words, and not at all.
#define RECOLLECT_COUNTING \
  __attribute__((target_clones("arch=icelake-server", "popcnt", "default")))

inline __attribute__((always_inline)) std::uint64_t DistanceOf(std::uint64_t a, std::uint64_t b) {
  return static_cast<std::uint64_t>(__builtin_popcountll(a) + __builtin_popcountll(b));
}

// near[d]: whether low[d], high[d] lie within `limit` of the entry's two words. Returns whether any
// does.
RECOLLECT_COUNTING bool FindNear(const std::uint64_t* low, const std::uint64_t* high,
                                 std::size_t count, const std::uint64_t* entry, std::uint64_t limit,
                                 std::uint8_t* near) {
  std::uint64_t any = 0;
  for (std::size_t d = 0; d < count; ++d) {
    const std::uint64_t distance = DistanceOf(low[d] ^ entry[0], high[d] ^ entry[1]);
    const std::uint64_t is_near = distance <= limit ? 1 : 0;
    near[d] = static_cast<std::uint8_t>(is_near);
    any |= is_near;
  }
  return any != 0;
}

// Adds the distances of all low[d], high[d] to an entry's two words, and their squares.
RECOLLECT_COUNTING void AddDistances(const std::uint64_t* low, const std::uint64_t* high,
                                     std::size_t count, const std::uint64_t* entry,
                                     std::uint64_t& sum, std::uint64_t& squares) {
  std::uint64_t own = 0, own_squares = 0;
  for (std::size_t d = 0; d < count; ++d) {
    const std::uint64_t distance = DistanceOf(low[d] ^ entry[0], high[d] ^ entry[1]);
    own += distance;
    own_squares += distance * distance;
  }
  sum += own;
  squares += own_squares;
}

// votes[d] += whether any displacement at most one step from d is near.
void AddVotes(const std::vector<std::uint8_t>& near, const Displacements& grid,
              std::vector<std::uint8_t>& along_rows, std::uint16_t* votes) {
  const auto columns = static_cast<std::size_t>(grid.columns);
  const auto rows = static_cast<std::size_t>(grid.rows);
  for (std::size_t y = 0; y < rows; ++y) {
    const std::uint8_t* in = near.data() + y * columns;
    std::uint8_t* out = along_rows.data() + y * columns;
    std::copy_n(in, columns, out);
    for (std::size_t x = 1; x < columns; ++x) {
      out[x] |= in[x - 1];
      out[x - 1] |= in[x];
    }
  }
  for (std::size_t y = 0; y < rows; ++y) {
    const std::uint8_t* own = along_rows.data() + y * columns;
    const std::uint8_t* above = y > 0 ? own - columns : own;
    const std::uint8_t* below = y + 1 < rows ? own + columns : own;
    std::uint16_t* to = votes + y * columns;
    for (std::size_t x = 0; x < columns; ++x) {
      to[x] = static_cast<std::uint16_t>(to[x] + (above[x] | own[x] | below[x]));
    }
  }
}

std::vector<std::vector<std::uint64_t>> PatternsOf(const Memory& memory,
                                                   std::span<const int> entries) {
  std::vector<std::vector<std::uint64_t>> patterns;
  for (const int entry : entries) patterns.push_back(memory.Pattern(entry));
  return patterns;
}

}  // namespace

std::vector<int> NearDistances(const Memory& memory, const DisplacedPatterns& live,
                               std::size_t stride, std::span<const int> usual, ThreadPool& pool) {
  const auto& patterns = live.patterns;
  const auto entries = PatternsOf(memory, usual);
  std::vector<int> near(static_cast<std::size_t>(memory.neurons()), -1);
  if (entries.empty()) return near;
  pool.For(memory.neurons(), kGrain, [&](std::int64_t begin, std::int64_t end) {
    std::vector<std::uint64_t> low(patterns.size()), high(patterns.size());
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) {
      std::size_t seen = 0;
      for (std::size_t d = 0; d < patterns.size(); d += stride, ++seen) {
        low[seen] = patterns[d][kWords * n];
        high[seen] = patterns[d][kWords * n + 1];
      }
      std::uint64_t sum = 0, squares = 0;
      for (const auto& entry : entries) {
        AddDistances(low.data(), high.data(), seen, &entry[kWords * n], sum, squares);
      }
      const std::size_t count = seen * entries.size();
      const double mean = static_cast<double>(sum) / static_cast<double>(count);
      const double variance =
          static_cast<double>(squares) / static_cast<double>(count) - mean * mean;
      // A neuron to which all entries look alike is of no use below one bit of spread.
      const double limit = mean - kNearDeviations * std::sqrt(std::max(1.0, variance));
      near[n] = std::max(-1, static_cast<int>(std::floor(limit)));
    }
  });
  return near;
}

std::vector<Look> LookCloser(const Memory& memory, const DisplacedPatterns& live,
                             std::span<const int> near, std::span<const int> entries,
                             ThreadPool& pool) {
  const auto stored = PatternsOf(memory, entries);
  const std::size_t count = live.patterns.size();
  std::vector<std::uint16_t> votes(stored.size() * count, 0);
  std::mutex adding;
  pool.For(memory.neurons(), kGrain, [&](std::int64_t begin, std::int64_t end) {
    std::vector<std::uint16_t> own(votes.size(), 0);
    std::vector<std::uint64_t> low(count), high(count);
    std::vector<std::uint8_t> is_near(count), along_rows(count);
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) {
      if (near[n] < 0) continue;
      for (std::size_t d = 0; d < count; ++d) {
        low[d] = live.patterns[d][kWords * n];
        high[d] = live.patterns[d][kWords * n + 1];
      }
      for (std::size_t e = 0; e < stored.size(); ++e) {
        if (FindNear(low.data(), high.data(), count, &stored[e][kWords * n],
                     static_cast<std::uint64_t>(near[n]), is_near.data())) {
          AddVotes(is_near, live.grid, along_rows, own.data() + e * count);
        }
      }
    }
    const std::lock_guard lock(adding);
    for (std::size_t i = 0; i < votes.size(); ++i) {
      votes[i] = static_cast<std::uint16_t>(votes[i] + own[i]);
    }
  });
  std::vector<Look> looks;
  for (std::size_t e = 0; e < stored.size(); ++e) {
    const auto first = votes.begin() + static_cast<std::ptrdiff_t>(e * count);
    const auto best = std::max_element(first, first + static_cast<std::ptrdiff_t>(count));
    looks.push_back({*best, static_cast<int>(best - first)});
  }
  return looks;
}

}  // namespace recollect::wnn
