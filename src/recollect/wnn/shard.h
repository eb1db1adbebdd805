#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "recollect/wnn/committee.h"
#include "recollect/wnn/memory.h"
#include "recollect/wnn/search.h"

namespace recollect::wnn {

struct ShardOptions {
  std::filesystem::path rendezvous;  // a file that all ranks reach and none has used before
  int rank = 0;                      // this process, in [0, ranks)
  int ranks = 1;
  std::string host = "127.0.0.1";  // name or address of this machine that the others reach
  double timeout_s = 8;            // how long to wait for the others before giving up
};

// One of several processes that search a map together, each holding a slice of it (c10d's Gloo
// carries their messages). Rank 0's entries come first, then rank 1's, and so on. The neurons'
// nearest entries meet in one all-reduce by minimum, so the answer is, bit for bit, that of one
// process holding the whole map. An entry whose label is its number in the slice (as Memory gives
// by default) is labelled with its number in the whole; other labels are taken as they are.
class Shard {
 public:
  // Waits for all ranks. `slice` and `pool` must outlive the shard. Throws Error when the others
  // do not come within the time-out or hold memories of another network.
  Shard(const Memory& slice, ThreadPool& pool, const ShardOptions& options);
  ~Shard();

  int first_entry() const { return first_entry_; }                  // number of the slice's entry 0
  int entries() const { return static_cast<int>(labels_.size()); }  // of all ranks

  // All ranks must call this in step, with the same pattern and options; all get the result.
  // options.stop is not heeded; options.allowed is about the slice. Throws Error when a rank is
  // lost or the time-out passes; the shard is of no more use then.
  Recollection Recollect(std::span<const std::uint64_t> pattern, const SearchOptions& options = {});

 private:
  struct Group;
  const Memory& slice_;
  ThreadPool& pool_;
  std::unique_ptr<Group> group_;
  int first_entry_ = 0;
  std::vector<int> labels_;  // by entry, of all ranks
};

}  // namespace recollect::wnn
