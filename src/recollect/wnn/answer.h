#pragma once

#include <cstdint>
#include <span>

#include "recollect/core/random.h"

namespace recollect::wnn {

// A neuron's answer, the entry nearest to what it sees, packed so that the better of two answers
// is the smaller number: distance (8 bits), priority (23), entry (32), the top bit 0. However a
// search is cut up - blocks, threads, processes - its parts meet by taking the minimum.
using Answer = std::uint64_t;

// Worse than any answer: the neuron has seen no entry.
inline constexpr Answer kNoAnswer = ~Answer{0} >> 1;

inline Answer MakeAnswer(int distance, std::uint64_t priority, int entry) {
  return static_cast<Answer>(distance) << 55 | priority << 32 | static_cast<std::uint32_t>(entry);
}
inline int AnswerDistance(Answer answer) { return static_cast<int>(answer >> 55); }
inline int AnswerEntry(Answer answer) { return static_cast<int>(answer & 0x7fffffff); }

// Ties: a neuron picks at random among its nearest entries. The dice are a function of the seed,
// the image, the neuron and the entry only, so any search that is exact throws the same ones.
class TieBreak {
 public:
  TieBreak(std::uint64_t seed, std::span<const std::uint64_t> pattern) : salt_(Scramble(seed)) {
    for (const std::uint64_t word : pattern) {
      salt_ = (salt_ ^ word) * 0x9e3779b97f4a7c15ULL;
      salt_ ^= salt_ >> 32;
    }
  }

  std::uint64_t NeuronSalt(int neuron) const {
    return Scramble(salt_ + static_cast<std::uint64_t>(neuron));
  }
  // 23 bits; the lowest wins, and of equals the lowest entry.
  static std::uint64_t Priority(std::uint64_t neuron_salt, int entry) {
    return Scramble(neuron_salt ^ static_cast<std::uint64_t>(entry)) >> 41;
  }

 private:
  std::uint64_t salt_;
};

}  // namespace recollect::wnn
