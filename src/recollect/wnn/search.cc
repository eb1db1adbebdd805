#include "recollect/wnn/search.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <utility>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/wnn/kernel.h"
#include "recollect/wnn/kernel_common.h"
#include "recollect/wnn/tally.h"

namespace recollect::wnn {
namespace {

constexpr int kPilot = 64;   // neurons that are asked before the rest get a hint from them
constexpr int kHints = 4;    // entries in the hint
constexpr int kGrain = 128;  // neurons a thread takes at a time
constexpr int kMaxBatch = 16;

const Kernel& KernelOf(const SearchOptions& options) {
  return options.kernel ? *options.kernel : *Kernels().front();
}

void Check(const Memory& memory, std::span<const std::uint64_t> pattern) {
  Require(pattern.size() == static_cast<std::size_t>(memory.neurons()) * kWords, "pattern",
          fmt::format("{} words where the network has {} neurons of {}", pattern.size(),
                      memory.neurons(), kWords));
}

// The blocks to look at and which of their frames.
std::vector<ScanBlock> BlocksOf(const Memory& memory, const EntrySet* allowed) {
  std::vector<ScanBlock> blocks;
  for (std::size_t b = 0; b < memory.blocks().size(); ++b) {
    const BlockView& view = memory.blocks()[b];
    if (view.frames == 0) continue;
    std::uint64_t mask = ~std::uint64_t{0} >> (64 - view.frames);
    if (allowed) mask &= b < allowed->masks().size() ? allowed->masks()[b] : 0;
    if (mask == 0) continue;
    const auto plane = static_cast<std::ptrdiff_t>(memory.neurons()) * view.capacity;
    blocks.push_back({view.words, view.words + plane, view.capacity, memory.first_entry(b), mask});
  }
  return blocks;
}

// One image's way through the memory.
class Search {
 public:
  Search(const Memory& memory, std::span<const std::uint64_t> pattern, ThreadPool& pool,
         const SearchOptions& options)
      : memory_(memory),
        pool_(pool),
        kernel_(KernelOf(options)),
        blocks_(BlocksOf(memory, options.allowed)),
        answers_(static_cast<std::size_t>(memory.neurons()), kNoAnswer),
        query_{pattern.data(), TieBreak(options.tie_seed, pattern), answers_.data()} {}

  bool empty() const { return blocks_.empty(); }

  void Ask(int begin, int end, std::int64_t grain) {
    pool_.For(end - begin, grain, [&](std::int64_t from, std::int64_t to) {
      const int first = begin + static_cast<int>(from), last = begin + static_cast<int>(to);
      Hint(first, last);
      std::int64_t words = 0;
      for (const ScanBlock& block : blocks_) words += kernel_.scan(block, query_, first, last);
      words_read_ += words;
    });
  }

  // Entries that neurons asked from now on try first: a near one lets them skip most of the rest.
  void TakeHints(const Tally& tally, int neurons) {
    hints_.clear();
    std::vector<std::pair<int, int>> by_votes;  // votes of the label, entry
    for (int n = std::max(0, neurons - kPilot); n < neurons; ++n) {
      const int entry = AnswerEntry(answer(n));
      by_votes.push_back({tally.votes(memory_.label(entry)), entry});
    }
    std::sort(by_votes.rbegin(), by_votes.rend());
    for (const auto& [votes, entry] : by_votes) {
      if (!hints_.empty() && hints_.back().entry == entry) continue;
      if (static_cast<int>(hints_.size()) == kHints) break;
      const std::size_t b = memory_.BlockOf(entry);
      const BlockView& view = memory_.blocks()[b];
      const std::uint64_t* low = view.words + (entry - memory_.first_entry(b));
      hints_.push_back(
          {low, low + std::ptrdiff_t{memory_.neurons()} * view.capacity, view.capacity, entry});
    }
  }

  Answer answer(int neuron) const { return answers_[static_cast<std::size_t>(neuron)]; }

  Recollection Finish() {
    Recollection result = CountVotes(memory_, std::move(answers_));
    result.words_read = words_read_;
    return result;
  }

 private:
  struct EntryWords {
    const std::uint64_t* low;
    const std::uint64_t* high;
    int stride;
    int entry;
  };

  void Hint(int begin, int end) {
    for (const EntryWords& hint : hints_) {
      for (int n = begin; n < end; ++n) {
        const std::ptrdiff_t at = std::ptrdiff_t{n} * hint.stride;
        const std::uint64_t* q = query_.pattern + std::ptrdiff_t{n} * kWords;
        const int distance =
            std::popcount(hint.low[at] ^ q[0]) + std::popcount(hint.high[at] ^ q[1]);
        query_.answers[n] = Better(query_.answers[n], query_.ties, n, distance, hint.entry);
      }
    }
  }

  const Memory& memory_;
  ThreadPool& pool_;
  const Kernel& kernel_;
  std::vector<ScanBlock> blocks_;
  std::vector<Answer> answers_;
  ScanQuery query_;
  std::vector<EntryWords> hints_;
  std::atomic<std::int64_t> words_read_ = 0;
};

}  // namespace

Recollection Recollect(const Memory& memory, std::span<const std::uint64_t> pattern,
                       ThreadPool& pool, const SearchOptions& options) {
  Check(memory, pattern);
  Search search(memory, pattern, pool, options);
  if (search.empty()) return search.Finish();
  const int neurons = memory.neurons();
  Tally tally(memory.labels(), neurons, options.error_bound);
  int asked = 0;
  while (asked < neurons) {
    if (asked > 0) {
      if (options.stop == Stop::kCertain && tally.Certain()) break;
      if (options.stop == Stop::kConfident && tally.Confident()) break;
      search.TakeHints(tally, asked);
    }
    // Small steps at first, then a sixteenth of what has been read; all at once if none may stop.
    const int rest = neurons - asked;
    int step = std::min(rest, std::max(kPilot, asked / 16));
    if (options.stop == Stop::kNever && asked > 0) step = rest;
    search.Ask(asked, asked + step, options.stop == Stop::kNever && asked > 0 ? kGrain : 8);
    for (int n = asked; n < asked + step; ++n)
      tally.Add(memory.label(AnswerEntry(search.answer(n))));
    asked += step;
  }
  return search.Finish();
}

std::vector<Recollection> RecollectBatch(const Memory& memory,
                                         std::span<const std::span<const std::uint64_t>> patterns,
                                         ThreadPool& pool, const SearchOptions& options) {
  const Kernel& kernel = KernelOf(options);
  const std::vector<ScanBlock> blocks = BlocksOf(memory, options.allowed);
  std::vector<Recollection> results;
  for (std::size_t first = 0; first < patterns.size(); first += kMaxBatch) {
    const auto batch =
        patterns.subspan(first, std::min<std::size_t>(kMaxBatch, patterns.size() - first));
    std::vector<std::vector<Answer>> answers(batch.size());
    std::vector<ScanQuery> queries;
    for (std::size_t i = 0; i < batch.size(); ++i) {
      Check(memory, batch[i]);
      answers[i].assign(static_cast<std::size_t>(memory.neurons()), kNoAnswer);
      queries.push_back({batch[i].data(), TieBreak(options.tie_seed, batch[i]), answers[i].data()});
    }
    pool.For(memory.neurons(), kGrain, [&](std::int64_t begin, std::int64_t end) {
      for (const ScanBlock& block : blocks) {
        kernel.scan_batch(block, queries.data(), static_cast<int>(queries.size()),
                          static_cast<int>(begin), static_cast<int>(end));
      }
    });
    for (auto& answer : answers) results.push_back(CountVotes(memory, std::move(answer)));
  }
  return results;
}

}  // namespace recollect::wnn
