#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "recollect/wnn/encoder.h"
#include "recollect/wnn/memory.h"

namespace recollect {
class ThreadPool;
}

namespace recollect::wnn {

// The committee's second look: at a few entries only, but under displacements of the live image
// finer than a search of the whole memory can afford. A neuron votes for every entry that lies
// nearer to what it sees than entries usually do by kNearDeviations standard deviations, under the
// displacement that it shares with the others, give or take one step. See docs/recognition.md, "A
// closer look".

inline constexpr double kNearDeviations = 3;

// By neuron, the largest distance at which it votes, -1: none. `usual`: entries to learn that
// from, seen under all of `displacements`.
std::vector<int> NearDistances(const Memory& memory, const DisplacedPatterns& live,
                               std::span<const int> displacements, std::span<const int> usual,
                               ThreadPool& pool);

// An entry, and the displacement about which to look at it.
struct Candidate {
  int entry = 0;
  int around = 0;
};
struct Look {
  int votes = 0;
  int displacement = 0;  // under which it got these; of equals the first
};
// By candidate, its votes under the displacement that gives most, among those at most `reach` steps
// of the grid from its own.
std::vector<Look> LookCloser(const Memory& memory, const DisplacedPatterns& live,
                             std::span<const int> near, std::span<const Candidate> candidates,
                             int reach, ThreadPool& pool);

// By neuron, whether it gave one of a look's votes.
std::vector<bool> VotersOf(const Memory& memory, const DisplacedPatterns& live,
                           std::span<const int> near, const Candidate& candidate, int reach,
                           const Look& look);

}  // namespace recollect::wnn
