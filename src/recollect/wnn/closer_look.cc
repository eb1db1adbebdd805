#include "recollect/wnn/closer_look.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <mutex>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/wnn/kernel.h"

namespace recollect::wnn {
namespace {

constexpr int kGrain = 16;  // neurons that a thread takes at a time
// A neuron that is near more of the usual entries tells none of them apart: it sees the camera's
// own frame. Not a share of them: of a short road, every lap's views of one place are a good part.
constexpr int kCommon = 16;

NeuronViews ViewsOf(const DisplacedPatterns& live, std::size_t neuron) {
  return {live.Of(neuron, 0).data(), live.Of(neuron, 1).data(), live.grid.count()};
}

std::vector<std::vector<std::uint64_t>> PatternsOf(const Memory& memory,
                                                   std::span<const int> entries) {
  std::vector<std::vector<std::uint64_t>> patterns;
  for (const int entry : entries) patterns.push_back(memory.Pattern(entry));
  return patterns;
}

// One neuron's words of all patterns, side by side.
void Gather(const std::vector<std::vector<std::uint64_t>>& patterns, std::size_t neuron,
            std::vector<std::uint64_t>& words) {
  for (std::size_t i = 0; i < patterns.size(); ++i) {
    std::copy_n(&patterns[i][kWords * neuron], kWords, &words[kWords * i]);
  }
}

constexpr std::size_t kStride = 64;  // votes of a row of displacements, which has fewer

// The displacement of most votes, of equals the first.
int MostVoted(const std::int16_t* votes, const Displacements& grid) {
  const auto size = kStride * static_cast<std::size_t>(grid.rows);
  std::int16_t most = 0;
  for (std::size_t i = 0; i < size; ++i) most = std::max(most, votes[i]);
  const auto at = static_cast<int>(std::find(votes, votes + size, most) - votes);
  return at / int{kStride} * grid.columns + at % int{kStride};
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
  const auto entries = PatternsOf(memory, usual);
  std::vector<int> near(static_cast<std::size_t>(memory.neurons()), -1);
  if (entries.empty()) return near;
  pool.For(memory.neurons(), kGrain, [&](std::int64_t begin, std::int64_t end) {
    std::vector<std::uint64_t> own(kWords * entries.size());
    std::vector<std::uint64_t> seen(static_cast<std::size_t>(live.grid.count() / 64 + 1));
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) {
      Gather(entries, n, own);
      std::uint64_t sum = 0, squares = 0;
      Kernels().front()->add_distances(ViewsOf(live, n), own.data(),
                                       static_cast<int>(entries.size()), sum, squares);
      const double count = static_cast<double>(entries.size()) * live.grid.count();
      const double mean = static_cast<double>(sum) / count;
      const double variance = static_cast<double>(squares) / count - mean * mean;
      // A neuron to which all entries look alike is of no use below one bit of spread.
      const double limit = mean - kNearDeviations * std::sqrt(std::max(1.0, variance));
      near[n] = std::max(-1, static_cast<int>(std::floor(limit)));
      int alike = 0;
      for (std::size_t e = 0; e < entries.size() && near[n] >= 0; ++e) {
        alike +=
            Kernels().front()->find_near(ViewsOf(live, n), &own[kWords * e], near[n], seen.data());
      }
      if (alike > kCommon) near[n] = -1;
    }
  });
  return near;
}

std::vector<Look> LookCloser(const Memory& memory, const DisplacedPatterns& live,
                             std::span<const int> near, std::span<const int> entries,
                             std::span<const int> parts, ThreadPool& pool) {
  const auto stored = PatternsOf(memory, entries);
  const auto neurons = Sorted(parts, near.size());
  const Displacements& grid = live.grid;
  const auto size = kStride * static_cast<std::size_t>(grid.rows);  // votes of an entry
  std::vector<Look> looks(entries.size());
  for (Look& look : looks) look.displacements.resize(parts.empty() ? 1 : 1 + neurons.size());
  std::vector<std::int16_t> whole(entries.size() * size, 0);
  std::mutex adding;
  pool.For(static_cast<std::int64_t>(neurons.size()), 1, [&](std::int64_t begin, std::int64_t end) {
    Voter voter(live.grid);
    std::vector<std::int16_t> votes(whole.size());
    std::vector<std::uint64_t> own(kWords * entries.size());
    for (auto part = static_cast<std::size_t>(begin); part < static_cast<std::size_t>(end);
         ++part) {
      std::fill(votes.begin(), votes.end(), std::int16_t{0});
      for (const std::size_t n : neurons[part]) {
        if (near[n] < 0) continue;
        const NeuronViews views = ViewsOf(live, n);
        Gather(stored, n, own);
        for (std::size_t e = 0; e < stored.size(); ++e) {
          voter.Vote(views, &own[kWords * e], near[n], &votes[e * size]);
        }
      }
      const std::lock_guard lock(adding);
      for (std::size_t i = 0; i < whole.size(); ++i) {
        whole[i] = static_cast<std::int16_t>(whole[i] + votes[i]);
      }
      for (std::size_t e = 0; e < stored.size() && !parts.empty(); ++e) {
        const int best = MostVoted(&votes[e * size], grid);
        looks[e].displacements[1 + part] = best;
        looks[e].halves += VotesUnder(&votes[e * size], grid, best);
      }
    }
  });
  for (std::size_t e = 0; e < stored.size(); ++e) {
    const int best = MostVoted(&whole[e * size], grid);
    looks[e].displacements[0] = best;
    looks[e].halves += (parts.empty() ? 2 : 1) * VotesUnder(&whole[e * size], grid, best);
  }
  return looks;
}

std::vector<int> HalvesOf(const Memory& memory, const DisplacedPatterns& live,
                          std::span<const int> near, int entry, std::span<const int> parts,
                          std::span<const int> displacements) {
  const std::vector<std::uint64_t> stored = memory.Pattern(entry);
  Voter voter(live.grid);
  std::vector<int> halves;
  for (std::size_t n = 0; n < near.size(); ++n) {
    std::vector<std::int16_t> votes(kStride * static_cast<std::size_t>(live.grid.rows), 0);
    if (near[n] >= 0) voter.Vote(ViewsOf(live, n), &stored[kWords * n], near[n], votes.data());
    const auto under = [&](std::size_t which) {
      return int{VotesUnder(votes.data(), live.grid, displacements[which])};
    };
    halves.push_back(parts.empty() ? 2 * under(0)
                                   : under(0) + under(1 + static_cast<std::size_t>(parts[n])));
  }
  return halves;
}

}  // namespace recollect::wnn
