#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "recollect/wnn/committee.h"
#include "recollect/wnn/memory.h"

namespace recollect {
class ThreadPool;
}

namespace recollect::wnn {

struct FatFastOptions {
  int row_limit = 0;       // entries kept of those that share a substring, at random; 0: all
  std::uint64_t seed = 1;  // of that choice
};

// Fat-Fast VG-RAM (Forechi et al. 2015): each pattern is cut into 8 substrings of 16 bits, and for
// each of them a table lists the entries by its value. A neuron compares what it sees only with
// the entries that share one of its 8 substrings. That finds the nearest entry for sure when it is
// at most 7 bits away and the rows are not limited; a neuron that finds none answers at random.
// Tables are compact: keys sorted, reached through their upper 8 bits. Takes 8 * 6 bytes an entry
// and neuron without a limit.
class FatFast {
 public:
  // `memory` must outlive the tables; entries it gets later are not found.
  FatFast(const Memory& memory, ThreadPool& pool, const FatFastOptions& options = {});

  // words_read counts the patterns compared, not the tables.
  Recollection Recollect(std::span<const std::uint64_t> pattern, ThreadPool& pool,
                         std::uint64_t tie_seed = 1) const;

  std::size_t bytes() const;  // of the tables

 private:
  static constexpr int kTables = 8;
  struct Tables {                        // of one neuron
    std::vector<std::uint32_t> starts;   // kTables x 256 + 1: where keys of an upper byte begin
    std::vector<std::uint16_t> keys;     // sorted within a table
    std::vector<std::uint32_t> entries;  // one a key
  };
  struct EntryWords {
    const std::uint64_t* low;
    const std::uint64_t* high;
    int stride;  // words from a neuron to the next
  };

  Tables Build(int neuron, const FatFastOptions& options) const;
  int Distance(int neuron, int entry, const std::uint64_t* query) const;

  const Memory& memory_;
  std::vector<EntryWords> words_;  // by entry
  std::vector<Tables> tables_;     // by neuron
};

}  // namespace recollect::wnn
