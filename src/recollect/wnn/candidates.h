#pragma once

#include <vector>

#include "recollect/wnn/asking.h"
#include "recollect/wnn/entry_set.h"
#include "recollect/wnn/memory.h"
#include "recollect/wnn/tally.h"

namespace recollect::wnn {

// The labels that got most votes so far. A neuron not yet asked may vote for no candidate but the
// one whose entry is nearest to what it sees, the dice of ties included; finding that one means
// reading some entries, not the whole memory.
struct Candidates {
  std::vector<int> labels;   // most votes first, of equals the lowest
  std::vector<int> entries;  // all of theirs that the search may look at
};

// What a search that stopped early has found out.
struct Verdict {
  int winner = -1;
  double confidence = 0;  // an estimate of the full committee's
};

// At most max_labels candidates with at most max_entries entries in all.
Candidates ChooseCandidates(const Memory& memory, const Tally& tally, const EntrySet* allowed,
                            int max_labels, int max_entries);

// Peeks for the candidates at neurons [tally.read(), all), whose answers are provisional from then
// on. Returns, by candidate, the neurons that may vote for it, in order of their numbers: disjoint,
// and all such neurons together if there is a candidate at all.
std::vector<std::vector<int>> Peek(const Memory& memory, Asking& asking, const Tally& tally,
                                   const Candidates& candidates);

}  // namespace recollect::wnn
