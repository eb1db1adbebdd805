#include "recollect/wnn/search.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <utility>
#include <vector>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"

namespace recollect::wnn {
namespace {

// The nearest entry of one neuron among those of one row of a block.
Answer ScanRow(const std::uint64_t* low, const std::uint64_t* high, int frames, int first_entry,
               const std::uint64_t* query, std::uint64_t salt, Answer best) {
  for (int i = 0; i < frames; ++i) {
    const int distance = std::popcount(low[i] ^ query[0]) + std::popcount(high[i] ^ query[1]);
    if (distance > AnswerDistance(best)) continue;
    const int entry = first_entry + i;
    best = std::min(best, MakeAnswer(distance, TieBreak::Priority(salt, entry), entry));
  }
  return best;
}

}  // namespace

Recollection Recollect(const Memory& memory, std::span<const std::uint64_t> pattern,
                       ThreadPool& pool, const SearchOptions& options) {
  const int neurons = memory.neurons();
  Require(pattern.size() == static_cast<std::size_t>(neurons) * kWords, "pattern",
          fmt::format("{} words where the network has {} neurons of {}", pattern.size(), neurons,
                      kWords));
  const TieBreak ties(options.tie_seed, pattern);
  std::vector<Answer> answers(static_cast<std::size_t>(neurons), kNoAnswer);
  pool.For(neurons, 128, [&](std::int64_t begin, std::int64_t end) {
    for (std::size_t b = 0; b < memory.blocks().size(); ++b) {
      const BlockView& block = memory.blocks()[b];
      for (std::int64_t n = begin; n < end; ++n) {
        const std::uint64_t* low = block.words + n * block.capacity;
        const std::uint64_t* high = low + std::ptrdiff_t{neurons} * block.capacity;
        Answer& answer = answers[static_cast<std::size_t>(n)];
        answer = ScanRow(low, high, block.frames, memory.first_entry(b),
                         &pattern[static_cast<std::size_t>(n) * kWords],
                         ties.NeuronSalt(static_cast<int>(n)), answer);
      }
    }
  });
  return CountVotes(memory, std::move(answers));
}

}  // namespace recollect::wnn
