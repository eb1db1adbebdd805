#include "recollect/wnn/compressed.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <utility>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/core/random.h"

namespace recollect::wnn {
namespace {

using Bits = std::array<std::uint64_t, kWords>;

int Distance(const Bits& a, const Bits& b) {
  return std::popcount(a[0] ^ b[0]) + std::popcount(a[1] ^ b[1]);
}

// The nearest centre of each pattern, the first of equals.
std::vector<int> Assign(const std::vector<Bits>& patterns, const std::vector<Bits>& centres) {
  std::vector<int> cluster(patterns.size());
  for (std::size_t i = 0; i < patterns.size(); ++i) {
    int least = kSynapses + 1;
    for (std::size_t c = 0; c < centres.size(); ++c) {
      const int distance = Distance(patterns[i], centres[c]);
      if (distance < least) {
        least = distance;
        cluster[i] = static_cast<int>(c);
      }
    }
  }
  return cluster;
}

// Moves each centre to its members' majority; one without members stays.
void Move(const std::vector<Bits>& patterns, const std::vector<int>& cluster,
          std::vector<Bits>& centres) {
  std::vector<std::array<int, kSynapses>> ones(centres.size());
  std::vector<int> members(centres.size(), 0);
  for (auto& counts : ones) counts.fill(0);
  for (std::size_t i = 0; i < patterns.size(); ++i) {
    const auto c = static_cast<std::size_t>(cluster[i]);
    ++members[c];
    for (std::size_t b = 0; b < kSynapses; ++b) {
      ones[c][b] += static_cast<int>(patterns[i][b / 64] >> (b % 64) & 1);
    }
  }
  for (std::size_t c = 0; c < centres.size(); ++c) {
    if (members[c] == 0) continue;
    centres[c] = {};
    for (std::size_t b = 0; b < kSynapses; ++b) {
      if (2 * ones[c][b] > members[c]) centres[c][b / 64] |= std::uint64_t{1} << (b % 64);
    }
  }
}

// Which patterns stay: exactly options.medoids different ones.
std::vector<int> Medoids(const std::vector<Bits>& patterns, const CompressionOptions& options,
                         std::uint64_t seed) {
  const auto k = static_cast<std::size_t>(options.medoids);
  std::vector<int> order(patterns.size());
  std::iota(order.begin(), order.end(), 0);
  Random random(seed);
  for (std::size_t i = 0; i < k; ++i) {
    const auto left = static_cast<std::int64_t>(order.size() - i);
    std::swap(order[i], order[i + static_cast<std::size_t>(random.Index(left))]);
  }
  std::vector<Bits> centres;
  for (std::size_t c = 0; c < k; ++c)
    centres.push_back(patterns[static_cast<std::size_t>(order[c])]);
  std::vector<int> cluster = Assign(patterns, centres);
  for (int round = 0; round < options.rounds; ++round) {
    Move(patterns, cluster, centres);
    cluster = Assign(patterns, centres);
  }
  std::vector<int> medoid(k, -1);
  for (std::size_t i = 0; i < patterns.size(); ++i) {
    const auto c = static_cast<std::size_t>(cluster[i]);
    const auto best = static_cast<std::size_t>(medoid[c]);
    if (medoid[c] < 0 || Distance(patterns[i], centres[c]) < Distance(patterns[best], centres[c])) {
      medoid[c] = static_cast<int>(i);
    }
  }
  // Empty clusters are filled from the random order, so that every neuron keeps as many.
  std::vector<bool> taken(patterns.size(), false);
  for (const int m : medoid) {
    if (m >= 0) taken[static_cast<std::size_t>(m)] = true;
  }
  auto spare = order.begin();
  for (int& m : medoid) {
    if (m >= 0) continue;
    while (taken[static_cast<std::size_t>(*spare)]) ++spare;
    m = *spare++;
  }
  return medoid;
}

}  // namespace

CompressedMemory::CompressedMemory(const Memory& memory, ThreadPool& pool,
                                   const CompressionOptions& options, const ProgressSink& progress)
    : kept_(memory.neurons()), labels_(memory.entry_labels().begin(), memory.entry_labels().end()) {
  Require(options.medoids > 0 && options.medoids <= memory.entries() && options.rounds >= 0,
          "compression",
          fmt::format("{} medoids of {} entries in {} rounds", options.medoids, memory.entries(),
                      options.rounds));
  const auto k = static_cast<std::size_t>(options.medoids);
  const auto neurons = static_cast<std::size_t>(memory.neurons());
  entry_of_.resize(neurons * k);
  std::vector<std::vector<std::uint64_t>> kept(k, std::vector<std::uint64_t>(neurons * kWords));
  constexpr std::size_t kStep = 64;  // between reports
  for (std::size_t first = 0; first < neurons; first += kStep) {
    const std::size_t count = std::min(kStep, neurons - first);
    pool.For(static_cast<std::int64_t>(count), 4, [&](std::int64_t begin, std::int64_t end) {
      for (auto n = first + static_cast<std::size_t>(begin);
           n < first + static_cast<std::size_t>(end); ++n) {
        std::vector<Bits> patterns;
        for (const BlockView& block : memory.blocks()) {
          const auto stride = static_cast<std::size_t>(block.capacity);
          for (std::size_t i = 0; i < static_cast<std::size_t>(block.frames); ++i) {
            patterns.push_back(
                {block.words[n * stride + i], block.words[(neurons + n) * stride + i]});
          }
        }
        const std::vector<int> medoids = Medoids(patterns, options, SubSeed(options.seed, n));
        for (std::size_t m = 0; m < k; ++m) {
          const Bits& bits = patterns[static_cast<std::size_t>(medoids[m])];
          entry_of_[n * k + m] = medoids[m];
          kept[m][n * kWords] = bits[0];
          kept[m][n * kWords + 1] = bits[1];
        }
      }
    });
    Report(progress, "compress", static_cast<std::int64_t>(first + count),
           static_cast<std::int64_t>(neurons));
  }
  for (const auto& pattern : kept) kept_.Append(pattern);
}

Recollection CompressedMemory::Recollect(std::span<const std::uint64_t> pattern, ThreadPool& pool,
                                         const SearchOptions& options) const {
  Require(!options.allowed, "compressed memory", "cannot be restricted to some entries",
          "restrict the full memory");
  std::vector<Answer> answers = AskAll(kept_, pattern, pool, options);
  const auto k = static_cast<std::size_t>(kept_.entries());
  for (std::size_t n = 0; n < answers.size(); ++n) {
    const auto medoid = static_cast<std::size_t>(AnswerEntry(answers[n]));
    answers[n] = MakeAnswer(AnswerDistance(answers[n]), 0, entry_of_[n * k + medoid]);
  }
  return CountVotes(labels_, std::move(answers));
}

}  // namespace recollect::wnn
