#include "recollect/wnn/closer_look.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <mutex>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/wnn/asking.h"
#include "recollect/wnn/kernel.h"

namespace recollect::wnn {
namespace {

constexpr int kGrain = 16;  // neurons that a thread takes at a time
// A neuron that is near more of the usual entries tells none of them apart: it sees the camera's
// own frame. Not a share of them: of a short road, every lap's views of one place are a good part.
constexpr int kCommon = 16;

// Some entries' words of one neuron at a time: a block keeps its frames' side by side, so this
// reads less than whole patterns would.
class Words {
 public:
  Words(const Memory& memory, std::span<const int> entries) : low_(entries.size()), high_(low_) {
    for (const int entry : entries) entries_.push_back(EntryIn(memory, entry));
  }
  void Take(std::size_t neuron) {
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      const std::size_t at = neuron * static_cast<std::size_t>(entries_[i].stride);
      low_[i] = entries_[i].low[at];
      high_[i] = entries_[i].high[at];
    }
  }
  const std::uint64_t* low() const { return low_.data(); }
  const std::uint64_t* high() const { return high_.data(); }

 private:
  std::vector<ScanEntry> entries_;
  std::vector<std::uint64_t> low_, high_;
};

constexpr std::size_t kStride = 64;  // votes of a row of displacements, which has fewer

// The displacement of most votes, of equals the first.
int MostVoted(const std::int16_t* votes, const Displacements& grid) {
  std::int16_t most = -1;
  int best = 0;
  for (int y = 0; y < grid.rows; ++y, votes += kStride) {
    std::int16_t most_of_row = 0;
    for (std::size_t x = 0; x < kStride; ++x) most_of_row = std::max(most_of_row, votes[x]);
    if (most_of_row <= most) continue;
    most = most_of_row;
    best = y * grid.columns + static_cast<int>(std::find(votes, votes + kStride, most) - votes);
  }
  return best;
}

std::int16_t VotesUnder(const std::int16_t* votes, const Displacements& grid, int displacement) {
  return votes[displacement / grid.columns * int{kStride} + displacement % grid.columns];
}

// Where one neuron is near an entry, and what it gives for that: a vote wherever it is near under a
// displacement at most one step away.
class Voter {
 public:
  explicit Voter(const Displacements& grid)
      : grid_(grid),
        near_(static_cast<std::size_t>(grid.count() / 64 + 2)),  // rows are read by whole words
        wide_(static_cast<std::size_t>(grid.rows) + 2),
        rows_(static_cast<std::size_t>(grid.rows)) {
    Require(grid.columns <= 56, "closer look", "56 columns of displacements are the most");
  }

  void Vote(const NeuronViews& views, const std::uint64_t* entry, int limit, std::int16_t* votes) {
    if (!kernel_.find_near(views, entry, limit, near_.data())) return;
    const std::uint64_t row_mask = (std::uint64_t{1} << grid_.columns) - 1;
    for (std::size_t row = 0; row < rows_.size(); ++row) {
      const std::size_t bit = row * static_cast<std::size_t>(grid_.columns);
      std::uint64_t own;
      std::memcpy(&own, reinterpret_cast<const char*>(near_.data()) + bit / 8, sizeof own);
      own = own >> (bit % 8) & row_mask;
      wide_[row + 1] = (own | own << 1 | own >> 1) & row_mask;
    }
    for (std::size_t row = 0; row < rows_.size(); ++row) {
      rows_[row] = wide_[row] | wide_[row + 1] | wide_[row + 2];
    }
    kernel_.add_votes(rows_.data(), grid_.rows, votes);
  }

 private:
  const Kernel& kernel_ = *Kernels().front();
  Displacements grid_;
  std::vector<std::uint64_t> near_;  // a bit a displacement, all rows in one
  std::vector<std::uint64_t> wide_;  // by row, with one before and one after: near it sideways
  std::vector<std::uint64_t> rows_;
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
                               std::span<const int> usual, ThreadPool& pool) {
  std::vector<int> near(static_cast<std::size_t>(memory.neurons()), -1);
  if (usual.empty()) return near;
  const Words entries(memory, usual);
  pool.For(memory.neurons(), kGrain, [&](std::int64_t begin, std::int64_t end) {
    Words own = entries;
    std::vector<std::uint64_t> least(usual.size());
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) {
      own.Take(n);
      Distances all;
      Kernels().front()->measure(ViewsOf(live.Of(n)), own.low(), own.high(),
                                 static_cast<int>(usual.size()), all, least.data());
      const double count = static_cast<double>(usual.size()) * live.grid.count();
      const double mean = static_cast<double>(all.sum) / count;
      const double variance = static_cast<double>(all.squares) / count - mean * mean;
      // A neuron to which all entries look alike is of no use below one bit of spread.
      const double limit = mean - kNearDeviations * std::sqrt(std::max(1.0, variance));
      near[n] = std::max(-1, static_cast<int>(std::floor(limit)));
      const auto alike = std::count_if(least.begin(), least.end(), [&](std::uint64_t distance) {
        return static_cast<int>(distance) <= near[n];
      });
      if (alike > kCommon) near[n] = -1;
    }
  });
  return near;
}

std::vector<Look> LookCloser(const Memory& memory, const DisplacedImage& live,
                             std::span<const int> near, std::span<const int> entries,
                             std::span<const int> parts, ThreadPool& pool) {
  const Words stored(memory, entries);
  const auto neurons = Sorted(parts, near.size());
  const Displacements& grid = live.grid();
  const auto size = kStride * static_cast<std::size_t>(grid.rows);  // votes of an entry
  std::vector<Look> looks(entries.size());
  for (Look& look : looks) {
    look.displacements.resize(parts.empty() ? 1 : 1 + neurons.size());
    look.votes.resize(look.displacements.size());
  }
  std::vector<std::int16_t> whole(entries.size() * size, 0);
  std::mutex adding;
  pool.For(static_cast<std::int64_t>(neurons.size()), 1, [&](std::int64_t begin, std::int64_t end) {
    Voter voter(grid);
    std::vector<std::int16_t> votes(whole.size());
    Words own = stored;
    std::vector<std::uint64_t> room;
    for (auto part = static_cast<std::size_t>(begin); part < static_cast<std::size_t>(end);
         ++part) {
      std::fill(votes.begin(), votes.end(), std::int16_t{0});
      for (const std::size_t n : neurons[part]) {
        if (near[n] < 0) continue;
        const NeuronViews views = ViewsOf(live.Of(n, room));
        own.Take(n);
        for (std::size_t e = 0; e < entries.size(); ++e) {
          const std::uint64_t words[kWords] = {own.low()[e], own.high()[e]};
          voter.Vote(views, words, near[n], &votes[e * size]);
        }
      }
      const std::lock_guard lock(adding);
      for (std::size_t i = 0; i < whole.size(); ++i) {
        whole[i] = static_cast<std::int16_t>(whole[i] + votes[i]);
      }
      for (std::size_t e = 0; e < entries.size() && !parts.empty(); ++e) {
        const int best = MostVoted(&votes[e * size], grid);
        looks[e].displacements[1 + part] = best;
        looks[e].votes[1 + part] = VotesUnder(&votes[e * size], grid, best);
        looks[e].halves += looks[e].votes[1 + part];
      }
    }
  });
  for (std::size_t e = 0; e < entries.size(); ++e) {
    const int best = MostVoted(&whole[e * size], grid);
    looks[e].displacements[0] = best;
    looks[e].votes[0] = VotesUnder(&whole[e * size], grid, best);
    looks[e].halves += (parts.empty() ? 2 : 1) * looks[e].votes[0];
  }
  return looks;
}

std::vector<int> HalvesOf(const Memory& memory, const DisplacedImage& live,
                          std::span<const int> near, int entry, std::span<const int> parts,
                          std::span<const int> displacements) {
  const std::vector<std::uint64_t> stored = memory.Pattern(entry);
  Voter voter(live.grid());
  std::vector<std::uint64_t> room;
  std::vector<int> halves;
  for (std::size_t n = 0; n < near.size(); ++n) {
    std::vector<std::int16_t> votes(kStride * static_cast<std::size_t>(live.grid().rows), 0);
    if (near[n] >= 0) {
      voter.Vote(ViewsOf(live.Of(n, room)), &stored[kWords * n], near[n], votes.data());
    }
    const auto under = [&](std::size_t which) {
      return int{VotesUnder(votes.data(), live.grid(), displacements[which])};
    };
    halves.push_back(parts.empty() ? 2 * under(0)
                                   : under(0) + under(1 + static_cast<std::size_t>(parts[n])));
  }
  return halves;
}

}  // namespace recollect::wnn
