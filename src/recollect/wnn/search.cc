#include "recollect/wnn/search.h"

#include <algorithm>
#include <deque>
#include <optional>
#include <utility>

#include "recollect/core/parallel.h"
#include "recollect/wnn/asking.h"
#include "recollect/wnn/certificate.h"
#include "recollect/wnn/runoff.h"
#include "recollect/wnn/tally.h"

namespace recollect::wnn {
namespace {

constexpr int kPilot = 64;         // neurons that are asked first; the rest get hints from them
constexpr std::size_t kHints = 4;  // entries in a hint
constexpr int kGrain = 128;        // neurons that a thread takes at a time
constexpr int kSmallGrain = 8;
constexpr std::size_t kMaxBatch = 16;
constexpr std::size_t kBatchHints = 2;

// The entries behind the last kPilot answers, those of the most voted labels.
std::vector<int> HintsFrom(const Memory& memory, const Asking& asking, const Tally& tally,
                           int asked, std::size_t count) {
  std::vector<std::pair<int, int>> by_votes;  // votes of the label, entry
  for (int n = std::max(0, asked - kPilot); n < asked; ++n) {
    const int entry = asking.entry(n);
    by_votes.push_back({tally.votes(memory.label(entry)), entry});
  }
  std::sort(by_votes.rbegin(), by_votes.rend());
  std::vector<int> hints;
  for (const auto& [votes, entry] : by_votes) {
    if (hints.empty() || hints.back() != entry) hints.push_back(entry);
    if (hints.size() == count) break;
  }
  return hints;
}

// Asks the first neurons and gives all others the entries they hint at for provisional answers.
void AskPilot(const Memory& memory, Asking& asking, int pilot) {
  Tally tally(memory.labels(), memory.neurons(), 1);
  asking.Ask(0, pilot, kSmallGrain);
  for (int n = 0; n < pilot; ++n) tally.Add(memory.label(asking.entry(n)));
  asking.SetHints(HintsFrom(memory, asking, tally, pilot, kBatchHints));
  asking.Peek(pilot, memory.neurons());
}

// Neurons are asked in the order of their numbers, which is random over the image: a few at
// first, then a sixteenth of those already asked, or all at once where none may be left out.
// Returns the winner where that is not simply the label with most votes.
std::optional<Verdict> AskUntil(const Memory& memory, Asking& asking,
                                const SearchOptions& options) {
  if (asking.empty()) return {};
  const int neurons = memory.neurons();
  // Peeking at many entries pays in a large memory only.
  const int rivals = std::clamp(memory.entries() / 64, 2, 64);
  // Half of the chance to err is for the count, half for the runoff.
  Tally tally(memory.labels(), neurons, options.error_bound / 2);
  for (int asked = 0; asked < neurons;) {
    if (asked > 0) asking.SetHints(HintsFrom(memory, asking, tally, asked, kHints));
    const bool all = options.stop == Stop::kNever && asked > 0;
    const int end = all ? neurons : std::min(neurons, asked + std::max(kPilot, asked / 16));
    asking.Ask(asked, end, all ? kGrain : kSmallGrain);
    for (; asked < end; ++asked) tally.Add(memory.label(asking.entry(asked)));
    if (options.stop == Stop::kCertain && (tally.Confident() || asked > neurons / 8)) {
      return AskUntilCertain(memory, asking, tally, options.allowed);
    }
    if (options.stop != Stop::kConfident) continue;
    if (tally.Confident()) return {};
    const Candidates candidates =
        ChooseCandidates(memory, tally, options.allowed, rivals, 4 * rivals);
    if (asked > kPilot && tally.ConfidentBut(candidates.labels)) {
      return AskRunoff(memory, asking, tally, candidates, options.error_bound / 2);
    }
  }
  return {};
}

}  // namespace

Recollection Recollect(const Memory& memory, std::span<const std::uint64_t> pattern,
                       ThreadPool& pool, const SearchOptions& options) {
  Asking asking(memory, pattern, pool, options);
  const std::optional<Verdict> verdict = AskUntil(memory, asking, options);
  Recollection result = CountVotes(memory.entry_labels(), asking.TakeAnswers());
  if (verdict && result.neurons_read < memory.neurons()) {
    result.winner = verdict->winner;
    result.confidence = verdict->confidence;
  }
  result.words_read = asking.words_read();
  return result;
}

std::vector<Answer> AskAll(const Memory& memory, std::span<const std::uint64_t> pattern,
                           ThreadPool& pool, const SearchOptions& options, int first_entry) {
  Asking asking(memory, pattern, pool, options, first_entry);
  SearchOptions all = options;
  all.stop = Stop::kNever;
  AskUntil(memory, asking, all);
  return asking.TakeAnswers();
}

std::vector<Recollection> RecollectBatch(const Memory& memory,
                                         std::span<const std::span<const std::uint64_t>> patterns,
                                         ThreadPool& pool, const SearchOptions& options) {
  const Kernel& kernel = KernelOf(options);
  const std::vector<ScanBlock> blocks = BlocksOf(memory, options);
  const int neurons = memory.neurons(), pilot = std::min(kPilot, neurons);
  std::vector<Recollection> results;
  for (std::size_t first = 0; first < patterns.size(); first += kMaxBatch) {
    std::deque<Asking> batch;
    std::vector<ScanQuery> queries;
    for (std::size_t i = first; i < std::min(patterns.size(), first + kMaxBatch); ++i) {
      batch.emplace_back(memory, patterns[i], pool, options);
      queries.push_back(batch.back().query());
    }
    if (!blocks.empty()) {
      for (Asking& asking : batch) AskPilot(memory, asking, pilot);
      pool.For(neurons - pilot, kGrain, [&](std::int64_t begin, std::int64_t end) {
        const int from = pilot + static_cast<int>(begin), to = pilot + static_cast<int>(end);
        for (const ScanBlock& block : blocks) {
          kernel.scan_batch(block, queries.data(), static_cast<int>(queries.size()), from, to);
        }
      });
    }
    for (Asking& asking : batch) {
      results.push_back(CountVotes(memory.entry_labels(), asking.TakeAnswers()));
    }
  }
  return results;
}

}  // namespace recollect::wnn
