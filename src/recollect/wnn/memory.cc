#include "recollect/wnn/memory.h"

#include <fmt/format.h>
#include <sys/mman.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <new>

#include "recollect/core/error.h"

namespace recollect::wnn {
namespace {

// Written in case of need only: maps of 100,000 key frames are to open in milliseconds.
void CheckLabel(int label) {
  if (label < 0) throw Error("memory", fmt::format("label {} is negative", label));
}

}  // namespace

void StoreFrame(std::span<const std::uint64_t> pattern, int frame, int capacity,
                std::uint64_t* block) {
  const auto stride = static_cast<std::size_t>(capacity);
  const std::size_t neurons = pattern.size() / kWords;
  std::uint64_t* low = block + frame;
  std::uint64_t* high = low + neurons * stride;
  for (std::size_t n = 0; n < neurons; ++n) {
    low[n * stride] = pattern[n * kWords];
    high[n * stride] = pattern[n * kWords + 1];
  }
}

void LoadFrame(const BlockView& block, int frame, std::span<std::uint64_t> pattern) {
  const auto stride = static_cast<std::size_t>(block.capacity);
  const std::size_t neurons = pattern.size() / kWords;
  const std::uint64_t* low = block.words + frame;
  const std::uint64_t* high = low + neurons * stride;
  for (std::size_t n = 0; n < neurons; ++n) {
    pattern[n * kWords] = low[n * stride];
    pattern[n * kWords + 1] = high[n * stride];
  }
}

void Memory::Free::operator()(std::uint64_t* words) const { std::free(words); }

// Zeroed, on huge pages where the system has them: streaming then misses no TLB entry.
Memory::Words Memory::Allocate(std::size_t count) {
  constexpr std::size_t kHugePage = std::size_t{2} << 20;
  const std::size_t bytes = count * sizeof(std::uint64_t);
  const std::size_t alignment = bytes >= kHugePage ? kHugePage : 64;
  const std::size_t rounded = (bytes + alignment - 1) / alignment * alignment;
  void* words = std::aligned_alloc(alignment, rounded);
  if (!words) throw std::bad_alloc();
  if (alignment == kHugePage) madvise(words, rounded, MADV_HUGEPAGE);
  std::memset(words, 0, bytes);
  return Words(static_cast<std::uint64_t*>(words));
}

Memory::Memory(int neurons) : neurons_(neurons) {
  Require(neurons > 0, "memory", "a network has at least one neuron");
}

void Memory::AddLabel(int label) {
  if (label >= label_count_) {
    label_count_ = label + 1;
    last_of_.resize(static_cast<std::size_t>(label_count_), -1);
  }
  int& last = last_of_[static_cast<std::size_t>(label)];
  before_.push_back(last);
  last = entries();
  labels_.push_back(label);
}

int Memory::Append(std::span<const std::uint64_t> pattern) { return Append(pattern, entries()); }

int Memory::Append(std::span<const std::uint64_t> pattern, int label) {
  Require(pattern.size() == static_cast<std::size_t>(neurons_) * kWords, "memory",
          fmt::format("a pattern of {} words where the network has {} neurons of {}",
                      pattern.size(), neurons_, kWords));
  CheckLabel(label);
  AddLabel(label);
  if (!last_is_owned_ || blocks_.back().frames == blocks_.back().capacity) {
    owned_.push_back(Allocate(BlockWords(neurons_)));
    first_entry_.push_back(entries() - 1);
    blocks_.push_back({owned_.back().get(), 0, kBlockFrames});
    last_is_owned_ = true;
  }
  BlockView& block = blocks_.back();
  StoreFrame(pattern, block.frames++, block.capacity, owned_.back().get());
  return entries() - 1;
}

void Memory::AddBlock(const BlockView& block) {
  std::vector<int> labels;
  for (int i = 0; i < block.frames; ++i) labels.push_back(entries() + i);
  AddBlock(block, labels);
}

void Memory::AddBlock(const BlockView& block, std::span<const int> labels) {
  Require(block.words != nullptr && block.capacity > 0 && block.capacity <= kBlockFrames &&
              block.capacity % 8 == 0 && block.frames >= 0 && block.frames <= block.capacity,
          "memory", fmt::format("a block of {} frames in {}", block.frames, block.capacity));
  Require(labels.size() == static_cast<std::size_t>(block.frames), "memory",
          fmt::format("{} labels for {} frames", labels.size(), block.frames));
  for (const int label : labels) CheckLabel(label);
  first_entry_.push_back(entries());
  for (const int label : labels) AddLabel(label);
  blocks_.push_back(block);
  last_is_owned_ = false;
}

std::vector<int> Memory::EntriesOf(int label) const {
  std::vector<int> entries;
  if (label < 0 || label >= label_count_) return entries;
  for (int entry = last_of_[static_cast<std::size_t>(label)]; entry >= 0;
       entry = before_[static_cast<std::size_t>(entry)]) {
    entries.push_back(entry);
  }
  return entries;
}

std::size_t Memory::BlockOf(int entry) const {
  Require(entry >= 0 && entry < entries(), "memory", fmt::format("no entry {}", entry));
  const auto after = std::upper_bound(first_entry_.begin(), first_entry_.end(), entry);
  return static_cast<std::size_t>(after - first_entry_.begin()) - 1;
}

std::vector<std::uint64_t> Memory::Pattern(int entry) const {
  const std::size_t block = BlockOf(entry);
  std::vector<std::uint64_t> pattern(static_cast<std::size_t>(neurons_) * kWords);
  LoadFrame(blocks_[block], entry - first_entry_[block], pattern);
  return pattern;
}

}  // namespace recollect::wnn
