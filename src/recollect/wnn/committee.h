#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "recollect/wnn/answer.h"
#include "recollect/wnn/memory.h"

namespace recollect::wnn {

struct LabelVotes {
  int label = 0;
  int votes = 0;
};

// What the committee of neurons recollects of an image (Forechi et al. 2018, section III-A).
struct Recollection {
  int winner = -1;        // the label with most votes, the lowest of equals; -1: nothing is stored
  double confidence = 0;  // (votes of the first - votes of the second) / votes of the first
  int neurons_read = 0;  // how many neurons were asked; fewer than all where a search stopped early
  std::int64_t words_read = 0;  // 64-bit words of memory that a single image's search went through
  std::vector<LabelVotes> histogram;  // labels that got votes, most votes first, then lowest label
  std::vector<Answer> answers;        // by neuron; kNoAnswer where it was not asked
};

// Counts the votes of the neurons that have an answer.
Recollection CountVotes(const Memory& memory, std::vector<Answer> answers);

// Shares of images whose answer lies within 0, 1, ... frames of the right one (Maximum Allowed
// Error). answers[i], truths[i]: frame numbers of image i. Returns one share an entry of `within`.
std::vector<double> SharesWithin(std::span<const int> answers, std::span<const int> truths,
                                 std::span<const int> within);

}  // namespace recollect::wnn
