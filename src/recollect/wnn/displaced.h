#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "recollect/wnn/encoder.h"
#include "recollect/wnn/search.h"

namespace recollect::wnn {

// The grids of displacements of both looks, and how one of the first is numbered in the second.
struct Grids {
  explicit Grids(const Encoder& encoder);
  int finer() const { return first.step / std::max(1, closer.step); }
  int Closer(int displacement) const {
    return (displacement / first.columns * closer.columns + displacement % first.columns) * finer();
  }

  Displacements first, closer;  // the same where there is no second look
  bool look_closer;
};

// What the committee recollects of a live image. Where the network has displacements, the image is
// searched for under each of them, all against the one memory, and MergeDisplaced joins the
// answers; search.stop is then not heeded. Where it also looks closer, the votes of
// the second look (LookCloser) are added, of the labels with most votes and those numbered two
// before to two after them. Otherwise this is Recollect of the image's pattern.
// Throws Error where the image is not of the encoder's size.
Recollection RecollectImage(const Memory& memory, Encoder& encoder, const ImageView& image,
                            ThreadPool& pool, const SearchOptions& search = {});

// answers[d][n]: neuron n's under displacement d, row by row of `grid`. Each neuron keeps its best
// answer over all displacements. An entry's label then gets the votes of those neurons only that
// agree on how the image is displaced, give or take one step, the ones a step off counted half:
// a place is one view of a rigid scene, chance likeness is not.
Recollection MergeDisplaced(std::span<const int> labels,
                            std::span<const std::vector<Answer>> answers,
                            const Displacements& grid);

}  // namespace recollect::wnn
