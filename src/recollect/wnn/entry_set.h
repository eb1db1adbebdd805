#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "recollect/wnn/memory.h"

namespace recollect::wnn {

// Entries that a search may look at: a window of the route, some laps, any set. A search costs in
// proportion to the groups of eight neighbouring frames of a block that hold an allowed one.
class EntrySet {
 public:
  explicit EntrySet(const Memory& memory);  // none; the memory must outlive the set

  // Throws Error on entries that the memory has not.
  EntrySet& Allow(int entry);
  EntrySet& AllowRange(int begin, int end);  // [begin, end)

  int size() const;
  bool Allows(int entry) const;
  // By block of the memory: bit i says whether frame i may be looked at. Blocks that came after
  // the set are not in it.
  std::span<const std::uint64_t> masks() const { return masks_; }

 private:
  const Memory* memory_;
  std::vector<std::uint64_t> masks_;
};

}  // namespace recollect::wnn
