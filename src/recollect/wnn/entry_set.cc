#include "recollect/wnn/entry_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "recollect/core/error.h"

namespace recollect::wnn {

EntrySet::EntrySet(const Memory& memory) : memory_(&memory), masks_(memory.blocks().size(), 0) {}

EntrySet& EntrySet::Allow(int entry) { return AllowRange(entry, entry + 1); }

EntrySet& EntrySet::AllowRange(int begin, int end) {
  Require(begin >= 0 && begin <= end && end <= memory_->entries(), "entry set",
          fmt::format("no entries {} to {} among {}", begin, end, memory_->entries()));
  for (int entry = begin; entry < end;) {
    const std::size_t block = memory_->BlockOf(entry);
    if (block >= masks_.size()) masks_.resize(block + 1, 0);
    const int from = entry - memory_->first_entry(block);
    const int to = std::min(end - memory_->first_entry(block), memory_->blocks()[block].frames);
    masks_[block] |= (~std::uint64_t{0} >> (64 - (to - from))) << from;
    entry += to - from;
  }
  return *this;
}

bool EntrySet::Allows(int entry) const {
  const std::size_t block = memory_->BlockOf(entry);
  return block < masks_.size() && (masks_[block] >> (entry - memory_->first_entry(block)) & 1);
}

int EntrySet::size() const {
  int count = 0;
  for (const std::uint64_t mask : masks_) count += std::popcount(mask);
  return count;
}

}  // namespace recollect::wnn
