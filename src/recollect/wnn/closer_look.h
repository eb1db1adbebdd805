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
// displacement that it shares with the others, give or take one step. Half its vote counts with
// the whole committee, half with the part of the image that it lies in: a scene far away moves as
// one, a wall nearby does not move with it. See docs/recognition.md, "A closer look".

inline constexpr double kNearDeviations = 3;

// By neuron, the largest distance at which it votes, -1: none. `usual`: entries to learn that
// from, seen under all displacements of `live`. Who is that near to more than 16 of them, as what
// sees the camera's own frame is, does not vote.
std::vector<int> NearDistances(const Memory& memory, const DisplacedPatterns& live,
                               std::span<const int> usual, ThreadPool& pool);

struct Look {
  // Half votes: of the whole image and of all parts; twice the former without parts.
  int halves = 0;
  // Under which they were given: the whole image's, then each part's; of equals the first.
  std::vector<int> displacements;
  std::vector<int> votes;  // under each of these
};
// By entry of `entries`, its votes under the displacements that give most. parts: as
// Encoder::parts; empty: none. Throws Error where a row has more than 56 displacements.
std::vector<Look> LookCloser(const Memory& memory, const DisplacedImage& live,
                             std::span<const int> near, std::span<const int> entries,
                             std::span<const int> parts, ThreadPool& pool);

// By neuron, how many of an entry's half votes are its own.
std::vector<int> HalvesOf(const Memory& memory, const DisplacedImage& live,
                          std::span<const int> near, int entry, std::span<const int> parts,
                          std::span<const int> displacements);

}  // namespace recollect::wnn
