#include "recollect/wnn/fat_fast.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <utility>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/wnn/asking.h"
#include "recollect/wnn/kernel_common.h"

namespace recollect::wnn {
namespace {

// Substring `table` of a pattern.
std::uint16_t Substring(std::uint64_t low, std::uint64_t high, int table) {
  return static_cast<std::uint16_t>((table < 4 ? low : high) >> (16 * (table % 4)));
}

}  // namespace

FatFast::FatFast(const Memory& memory, ThreadPool& pool, const FatFastOptions& options)
    : memory_(memory), tables_(static_cast<std::size_t>(memory.neurons())) {
  Require(options.row_limit >= 0, "fat-fast", "row_limit must not be negative");
  for (const BlockView& block : memory.blocks()) {
    const auto plane = static_cast<std::ptrdiff_t>(memory.neurons()) * block.capacity;
    for (int i = 0; i < block.frames; ++i) {
      words_.push_back({block.words + i, block.words + plane + i, block.capacity});
    }
  }
  pool.For(memory.neurons(), 16, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t n = begin; n < end; ++n) {
      tables_[static_cast<std::size_t>(n)] = Build(static_cast<int>(n), options);
    }
  });
}

FatFast::Tables FatFast::Build(int neuron, const FatFastOptions& options) const {
  struct Row {
    std::uint16_t key;
    std::uint32_t dice, entry;
    auto operator<=>(const Row&) const = default;
  };
  const std::uint64_t seed = SubSeed(options.seed, static_cast<std::uint64_t>(neuron));
  Tables tables;
  std::vector<Row> rows(words_.size());
  for (int table = 0; table < kTables; ++table) {
    for (std::size_t e = 0; e < words_.size(); ++e) {
      const std::ptrdiff_t at = std::ptrdiff_t{neuron} * words_[e].stride;
      const auto dice =
          static_cast<std::uint32_t>(SubSeed(seed + static_cast<std::uint64_t>(table), e));
      rows[e] = {Substring(words_[e].low[at], words_[e].high[at], table), dice,
                 static_cast<std::uint32_t>(e)};
    }
    std::sort(rows.begin(), rows.end());
    std::size_t next = 0;
    for (int byte = 0; byte < 256; ++byte) {
      tables.starts.push_back(static_cast<std::uint32_t>(tables.keys.size()));
      int kept = 0;
      for (; next < rows.size() && rows[next].key >> 8 == byte; ++next) {
        kept = next > 0 && rows[next - 1].key == rows[next].key ? kept + 1 : 1;
        if (options.row_limit > 0 && kept > options.row_limit) continue;
        tables.keys.push_back(rows[next].key);
        tables.entries.push_back(rows[next].entry);
      }
    }
  }
  tables.starts.push_back(static_cast<std::uint32_t>(tables.keys.size()));
  tables.keys.shrink_to_fit();
  tables.entries.shrink_to_fit();
  return tables;
}

int FatFast::Distance(int neuron, int entry, const std::uint64_t* query) const {
  const EntryWords& words = words_[static_cast<std::size_t>(entry)];
  const std::ptrdiff_t at = std::ptrdiff_t{neuron} * words.stride;
  return std::popcount(words.low[at] ^ query[0]) + std::popcount(words.high[at] ^ query[1]);
}

Recollection FatFast::Recollect(std::span<const std::uint64_t> pattern, ThreadPool& pool,
                                std::uint64_t tie_seed) const {
  CheckPattern(memory_, pattern);
  const TieBreak ties(tie_seed, pattern);
  std::vector<Answer> answers(tables_.size(), kNoAnswer);
  std::atomic<std::int64_t> compared = 0;
  pool.For(memory_.neurons(), words_.empty() ? memory_.neurons() : 64, [&](auto begin, auto end) {
    std::int64_t count = 0;
    for (auto n = static_cast<int>(begin); n < static_cast<int>(end) && !words_.empty(); ++n) {
      const Tables& tables = tables_[static_cast<std::size_t>(n)];
      const std::uint64_t* query = &pattern[static_cast<std::size_t>(n) * kWords];
      Answer& best = answers[static_cast<std::size_t>(n)];
      const auto compare = [&](int entry) {
        best = Better(best, ties, n, Distance(n, entry, query), entry);
        ++count;
      };
      for (int table = 0; table < kTables; ++table) {
        const std::uint16_t key = Substring(query[0], query[1], table);
        const auto* start = &tables.starts[static_cast<std::size_t>(256 * table + (key >> 8))];
        const auto keys = tables.keys.begin();
        const auto [from, to] = std::equal_range(keys + start[0], keys + start[1], key);
        for (auto i = from; i != to; ++i) {
          compare(static_cast<int>(tables.entries[static_cast<std::size_t>(i - keys)]));
        }
      }
      if (best == kNoAnswer) {
        compare(static_cast<int>(Scramble(ties.NeuronSalt(n)) % words_.size()));
      }
    }
    compared += count;
  });
  Recollection result = CountVotes(memory_.entry_labels(), std::move(answers));
  result.words_read = compared * kWords;
  return result;
}

std::size_t FatFast::bytes() const {
  std::size_t sum = 0;
  for (const Tables& t : tables_) {
    sum += t.starts.size() * sizeof(t.starts[0]) + t.keys.size() * sizeof(t.keys[0]) +
           t.entries.size() * sizeof(t.entries[0]);
  }
  return sum;
}

}  // namespace recollect::wnn
