#pragma once

#include <span>
#include <vector>

#include "recollect/wnn/encoder.h"
#include "recollect/wnn/memory.h"
#include "recollect/wnn/route.h"

namespace recollect::wnn {

// Which neurons voted for a label.
struct Voters {
  int label = -1;  // -1: there is none
  int votes = 0;   // of the histogram
  // By cell of the neuron grid, row by row: half votes, 0 to 4. A neuron gives one vote in the
  // first look - half a one where it sees the image a displacement off the others' - and one in the
  // second, half of it with the whole image and half with its part. Half their sum, rounded up, is
  // `votes`.
  std::vector<int> halves;
};

// Why the committee answered as it did.
struct Explanation {
  int columns = 0, rows = 0;  // of the neuron grid
  Voters winner, runner_up;
};

// The label with most votes among those that are neither the winner's place nor one ahead, behind
// or beside it; -1: all votes went there.
int RunnerUp(const Route& route, const Recollection& recollection);

// `recollection`: what RecollectImage gave for that image, memory and encoder. Encodes the image
// again. Throws Error where it was made with other options.
Explanation Explain(const Memory& memory, Encoder& encoder, const ImageView& image,
                    const Recollection& recollection, int runner_up);

}  // namespace recollect::wnn
