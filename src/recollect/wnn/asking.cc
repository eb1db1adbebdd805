#include "recollect/wnn/asking.h"

#include <fmt/format.h>

#include <algorithm>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"

namespace recollect::wnn {
namespace {

constexpr std::size_t kAhead = 4;  // blocks between asking memory for a row and reading it

// Scattered rows are not foreseen by the processor. Only the half that is always read is fetched.
void Prefetch(const ScanBlock& block, int neuron) {
  const std::uint64_t* row = block.high + std::ptrdiff_t{neuron} * block.capacity;
  for (int i = 0; i < block.capacity; i += 8) __builtin_prefetch(row + i);
}

}  // namespace

const Kernel& KernelOf(const SearchOptions& options) {
  return options.kernel ? *options.kernel : *Kernels().front();
}

void CheckPattern(const Memory& memory, std::span<const std::uint64_t> pattern) {
  Require(pattern.size() == static_cast<std::size_t>(memory.neurons()) * kWords, "pattern",
          fmt::format("{} words where the network has {} neurons of {}", pattern.size(),
                      memory.neurons(), kWords));
}

std::vector<ScanBlock> BlocksOf(const Memory& memory, const SearchOptions& options,
                                int first_entry) {
  std::vector<ScanBlock> blocks;
  for (std::size_t b = 0; b < memory.blocks().size(); ++b) {
    const BlockView& view = memory.blocks()[b];
    if (view.frames == 0) continue;
    std::uint64_t mask = ~std::uint64_t{0} >> (64 - view.frames);
    if (options.allowed) {
      const auto masks = options.allowed->masks();
      mask &= b < masks.size() ? masks[b] : 0;
    }
    if (mask == 0) continue;
    const auto plane = static_cast<std::ptrdiff_t>(memory.neurons()) * view.capacity;
    blocks.push_back(
        {view.words, view.words + plane, view.capacity, first_entry + memory.first_entry(b), mask});
  }
  return blocks;
}

ScanEntry EntryIn(const Memory& memory, int entry, int first_entry) {
  const std::size_t b = memory.BlockOf(entry);
  const BlockView& view = memory.blocks()[b];
  const std::uint64_t* low = view.words + (entry - memory.first_entry(b));
  return {low, low + std::ptrdiff_t{memory.neurons()} * view.capacity, view.capacity,
          first_entry + entry};
}

Asking::Asking(const Memory& memory, std::span<const std::uint64_t> pattern, ThreadPool& pool,
               const SearchOptions& options, int first_entry)
    : memory_(memory),
      pool_(pool),
      kernel_(KernelOf(options)),
      first_entry_(first_entry),
      blocks_(BlocksOf(memory, options, first_entry)),
      answers_(static_cast<std::size_t>(memory.neurons()), kNoAnswer),
      query_{pattern.data(), TieBreak(options.tie_seed, pattern), answers_.data()} {
  CheckPattern(memory, pattern);
}

void Asking::Ask(int begin, int end, int grain) {
  pool_.For(end - begin, grain, [&](std::int64_t from, std::int64_t to) {
    const int first = begin + static_cast<int>(from), last = begin + static_cast<int>(to);
    std::int64_t words = TryHints(first, last);
    for (const ScanBlock& block : blocks_) words += kernel_.scan(block, query_, first, last);
    words_read_ += words;
  });
}

void Asking::Ask(std::span<const int> neurons, int grain) {
  pool_.For(static_cast<std::int64_t>(neurons.size()), grain,
            [&](std::int64_t from, std::int64_t to) {
              std::int64_t words = 0;
              for (std::int64_t i = from; i < to; ++i) {
                const int n = neurons[static_cast<std::size_t>(i)];
                const int next = neurons[static_cast<std::size_t>(std::min(i + 1, to - 1))];
                for (std::size_t b = 0; b < blocks_.size(); ++b) {
                  const std::size_t ahead = b + kAhead;
                  const bool same = ahead < blocks_.size();
                  Prefetch(blocks_[same ? ahead : ahead % blocks_.size()], same ? n : next);
                  words += kernel_.scan(blocks_[b], query_, n, n + 1);
                }
              }
              words_read_ += words;
            });
}

void Asking::Peek(int begin, int end) {
  pool_.For(end - begin, 256, [&](std::int64_t from, std::int64_t to) {
    words_read_ += TryHints(begin + static_cast<int>(from), begin + static_cast<int>(to));
  });
}

void Asking::SetHints(std::span<const int> entries) {
  hints_.clear();
  for (const int entry : entries) hints_.push_back(EntryIn(memory_, entry, first_entry_));
}

std::int64_t Asking::TryHints(int begin, int end) {
  for (const ScanEntry& hint : hints_) kernel_.probe(hint, query_, begin, end);
  return static_cast<std::int64_t>(hints_.size()) * (end - begin) * kWords;
}

}  // namespace recollect::wnn
