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

// The displacements of a grid that lie at most `reach` steps from one of them.
struct Box {
  Box(const Displacements& grid, int around, int reach) {
    const int x = around % grid.columns, y = around / grid.columns;
    left = std::max(0, x - reach);
    top = std::max(0, y - reach);
    columns = std::min(grid.columns - 1, x + reach) - left + 1;
    rows = std::min(grid.rows - 1, y + reach) - top + 1;
    stride = grid.columns;
  }
  std::size_t count() const { return static_cast<std::size_t>(columns * rows); }
  int Displacement(int i) const { return (top + i / columns) * stride + left + i % columns; }
  // What lies in the box, row by row.
  void Cut(std::span<const std::uint64_t> all, std::uint64_t* cut) const {
    for (int row = 0; row < rows; ++row, cut += columns) {
      std::copy_n(all.begin() + (top + row) * stride + left, columns, cut);
    }
  }

  int left, top, columns, rows, stride;
};

// votes[i] += whether any displacement of the box at most one step from i is near.
void AddVotes(const std::uint8_t* near, const Box& box, std::uint8_t* along_rows,
              std::uint16_t* votes) {
  const auto columns = static_cast<std::size_t>(box.columns);
  const auto rows = static_cast<std::size_t>(box.rows);
  for (std::size_t y = 0; y < rows; ++y) {
    const std::uint8_t* in = near + y * columns;
    std::uint8_t* out = along_rows + y * columns;
    std::copy_n(in, columns, out);
    for (std::size_t x = 1; x < columns; ++x) {
      out[x] |= in[x - 1];
      out[x - 1] |= in[x];
    }
  }
  for (std::size_t y = 0; y < rows; ++y) {
    const std::uint8_t* own = along_rows + y * columns;
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
                               std::span<const int> displacements, std::span<const int> usual,
                               ThreadPool& pool) {
  const auto entries = PatternsOf(memory, usual);
  std::vector<int> near(static_cast<std::size_t>(memory.neurons()), -1);
  if (entries.empty()) return near;
  const std::size_t seen = displacements.size();
  pool.For(memory.neurons(), kGrain, [&](std::int64_t begin, std::int64_t end) {
    std::vector<std::uint64_t> low(seen), high(seen);
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) {
      const auto all_low = live.Of(n, 0), all_high = live.Of(n, 1);
      for (std::size_t d = 0; d < seen; ++d) {
        low[d] = all_low[static_cast<std::size_t>(displacements[d])];
        high[d] = all_high[static_cast<std::size_t>(displacements[d])];
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
                             std::span<const int> near, std::span<const Candidate> candidates,
                             int reach, ThreadPool& pool) {
  std::vector<int> entries;
  std::vector<Box> boxes;
  std::vector<std::size_t> begins = {0};  // of the votes of each box
  std::size_t most = 0;
  for (const Candidate& one : candidates) {
    entries.push_back(one.entry);
    boxes.emplace_back(live.grid, one.around, reach);
    begins.push_back(begins.back() + boxes.back().count());
    most = std::max(most, boxes.back().count());
  }
  const auto stored = PatternsOf(memory, entries);
  std::vector<std::uint16_t> votes(begins.back(), 0);
  std::mutex adding;
  pool.For(memory.neurons(), kGrain, [&](std::int64_t begin, std::int64_t end) {
    std::vector<std::uint16_t> own(votes.size(), 0);
    std::vector<std::uint64_t> low(most), high(most);
    std::vector<std::uint8_t> is_near(most), along_rows(most);
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) {
      if (near[n] < 0) continue;
      const auto limit = static_cast<std::uint64_t>(near[n]);
      for (std::size_t e = 0; e < boxes.size(); ++e) {
        boxes[e].Cut(live.Of(n, 0), low.data());
        boxes[e].Cut(live.Of(n, 1), high.data());
        if (FindNear(low.data(), high.data(), boxes[e].count(), &stored[e][kWords * n], limit,
                     is_near.data())) {
          AddVotes(is_near.data(), boxes[e], along_rows.data(), own.data() + begins[e]);
        }
      }
    }
    const std::lock_guard lock(adding);
    for (std::size_t i = 0; i < votes.size(); ++i) {
      votes[i] = static_cast<std::uint16_t>(votes[i] + own[i]);
    }
  });
  std::vector<Look> looks;
  for (std::size_t e = 0; e < boxes.size(); ++e) {
    const auto first = votes.begin() + static_cast<std::ptrdiff_t>(begins[e]);
    const auto best =
        std::max_element(first, first + static_cast<std::ptrdiff_t>(boxes[e].count()));
    looks.push_back({*best, boxes[e].Displacement(static_cast<int>(best - first))});
  }
  return looks;
}

std::vector<bool> VotersOf(const Memory& memory, const DisplacedPatterns& live,
                           std::span<const int> near, const Candidate& candidate, int reach,
                           const Look& look) {
  const std::vector<std::uint64_t> stored = memory.Pattern(candidate.entry);
  const Box box(live.grid, candidate.around, reach);
  std::vector<std::uint64_t> low(box.count()), high(box.count());
  std::vector<std::uint8_t> is_near(box.count()), along_rows(box.count());
  std::vector<bool> voters;
  for (std::size_t n = 0; n < near.size(); ++n) {
    std::vector<std::uint16_t> votes(box.count(), 0);
    box.Cut(live.Of(n, 0), low.data());
    box.Cut(live.Of(n, 1), high.data());
    if (near[n] >= 0 && FindNear(low.data(), high.data(), box.count(), &stored[kWords * n],
                                 static_cast<std::uint64_t>(near[n]), is_near.data())) {
      AddVotes(is_near.data(), box, along_rows.data(), votes.data());
    }
    bool voted = false;
    for (std::size_t i = 0; i < votes.size(); ++i) {
      voted = voted || (votes[i] > 0 && box.Displacement(static_cast<int>(i)) == look.displacement);
    }
    voters.push_back(voted);
  }
  return voters;
}

}  // namespace recollect::wnn
