#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "recollect/wnn/encoder.h"
#include "recollect/wnn/search.h"

namespace recollect::wnn {

// The grids of displacements of both looks; every finer()-th of the second is in the first.
struct Grids {
  explicit Grids(const Encoder& encoder);
  int finer() const { return first.step / std::max(1, closer.step); }

  Displacements first, closer;  // the same where there is no second look
  bool look_closer;
};

// What the committee recollects of a live image. Where the network has displacements, each neuron
// keeps the nearest entry under any of them (AskDisplaced) and MergeDisplaced counts the votes;
// search.stop is then not heeded. Where it also looks closer, the votes of
// the second look (LookCloser) are added, of the labels with most votes and those numbered two
// before to two after them. Otherwise this is Recollect of the image's pattern.
// Throws Error where the image is not of the encoder's size.
Recollection RecollectImage(const Memory& memory, Encoder& encoder, const ImageView& image,
                            ThreadPool& pool, const SearchOptions& search = {});

struct DisplacedAnswers {
  std::vector<Answer> answers;  // by neuron: the nearest entry under any displacement
  std::vector<int> seen_under;  // and the first displacement under which it is so near
};
// Goes through the memory once for all displacements. Throws Error on another network's patterns.
DisplacedAnswers AskDisplaced(const Memory& memory, const DisplacedPatterns& live, ThreadPool& pool,
                              const SearchOptions& search = {});

// An entry's label gets the votes of those neurons only that agree on how the image is displaced,
// give or take one step of the grid, the ones a step off counted half: a place is one view of a
// rigid scene, chance likeness is not.
Recollection MergeDisplaced(std::span<const int> labels, DisplacedAnswers asked,
                            const Displacements& grid);

}  // namespace recollect::wnn
