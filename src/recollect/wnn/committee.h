#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "recollect/wnn/answer.h"

namespace recollect::wnn {

// How much larger a live image shows the scene than an entry does (zoom.h): what lies at the
// window's edge has moved outwards by so many pixels of a 640 pixels wide image.
struct Zoom {
  double growth = 0;                                          // below zero: it has shrunk
  double variance = std::numeric_limits<double>::infinity();  // as if parts erred each by itself
};

struct LabelVotes {
  int label = 0;
  int votes = 0;
  Zoom zoom = {};  // of a closer look; unknown without one
};

// How a label was looked at under displacements.
struct LabelView {
  int label = 0;
  int entry = -1;  // of that label, the one that got these votes; -1: any of them
  int halves = 0;  // half votes
  // That its voters agree on, numbered by the grid of the look: those of the whole image, then,
  // where a second look cuts it into parts, those of each part.
  std::vector<int> displacements;
};

// What the committee of neurons recollects of an image (Forechi et al. 2018, section III-A).
struct Recollection {
  int winner = -1;        // the label with most votes, the lowest of equals; -1: nothing is stored
  double confidence = 0;  // (votes of the first - votes of the second) / votes of the first, of the
                          // full committee: an estimate where not all were asked
  int neurons_read = 0;  // how many neurons were asked; fewer than all where a search stopped early
  std::int64_t words_read = 0;  // 64-bit words of memory that a single image's search went through
  // Votes of the neurons asked, most votes first, then lowest label. After an early stop these
  // need not be a fair sample: neurons that settle the matter are asked first.
  std::vector<LabelVotes> histogram;
  std::vector<Answer> answers;  // by neuron; kNoAnswer where it was not asked

  // How it came to this, where images are looked at under displacements (displaced.h); else empty.
  std::vector<int> seen_under;        // by neuron: the displacement of its answer
  std::vector<LabelView> first_look;  // by rising label
  std::vector<int> near;              // by neuron: how far it votes in the second look; -1: nowhere
  std::vector<LabelView> second_look;  // by rising label
};

// Counts the votes of the neurons that have an answer. labels: by entry, each >= 0.
Recollection CountVotes(std::span<const int> labels, std::vector<Answer> answers);

// Shares of images whose answer lies within 0, 1, ... frames of the right one (Maximum Allowed
// Error). answers[i], truths[i]: frame numbers of image i. Returns one share an entry of `within`.
std::vector<double> SharesWithin(std::span<const int> answers, std::span<const int> truths,
                                 std::span<const int> within);

}  // namespace recollect::wnn
