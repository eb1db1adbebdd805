#include "recollect/wnn/explanation.h"

#include <algorithm>
#include <cstdlib>
#include <optional>

#include "recollect/core/error.h"
#include "recollect/wnn/closer_look.h"
#include "recollect/wnn/displaced.h"

namespace recollect::wnn {
namespace {

const LabelView* ViewOf(const std::vector<LabelView>& views, int label) {
  const auto found = std::find_if(views.begin(), views.end(),
                                  [label](const LabelView& view) { return view.label == label; });
  return found == views.end() ? nullptr : &*found;
}

// Half votes of a neuron that answered under one displacement for voters that agree on another.
int HalvesUnder(const Displacements& grid, int own, int agreed) {
  if (own == agreed) return 2;
  const bool near = std::abs(own % grid.columns - agreed % grid.columns) <= 1 &&
                    std::abs(own / grid.columns - agreed / grid.columns) <= 1;
  return near ? 1 : 0;
}

// By neuron, in the first look.
std::vector<int> FirstHalves(const Memory& memory, const Grids& grids,
                             const Recollection& recollection, int label) {
  std::vector<int> halves(recollection.answers.size(), 0);
  const LabelView* view = ViewOf(recollection.first_look, label);
  for (std::size_t n = 0; n < halves.size(); ++n) {
    const Answer answer = recollection.answers[n];
    if (answer == kNoAnswer || memory.label(AnswerEntry(answer)) != label) continue;
    halves[n] =
        view ? HalvesUnder(grids.first, recollection.seen_under[n], view->displacements[0]) : 2;
  }
  return halves;
}

Voters VotersFor(const Memory& memory, const Encoder& encoder, const DisplacedImage* live,
                 const Recollection& recollection, int label) {
  Voters voters;
  voters.label = label;
  if (label < 0) return voters;
  const Grids grids(encoder);
  std::vector<int> halves = FirstHalves(memory, grids, recollection, label);
  const LabelView* view = ViewOf(recollection.second_look, label);
  if (live && view) {
    const auto more = HalvesOf(memory, *live, recollection.near, view->entry, encoder.parts(),
                               view->displacements);
    for (std::size_t n = 0; n < halves.size(); ++n) halves[n] += more[n];
  }
  for (const LabelVotes& one : recollection.histogram) {
    if (one.label == label) voters.votes = one.votes;
  }
  const int columns = encoder.synapses().neurons_x();
  voters.halves.resize(halves.size());
  for (std::size_t n = 0; n < halves.size(); ++n) {
    const Pixel cell = encoder.synapses().Cell(static_cast<int>(n));
    voters.halves[static_cast<std::size_t>(cell.y * columns + cell.x)] = halves[n];
  }
  return voters;
}

}  // namespace

int RunnerUp(const Route& route, const Recollection& recollection) {
  for (const LabelVotes& one : recollection.histogram) {
    if (!route.WithinOne(recollection.winner, one.label)) return one.label;
  }
  return -1;
}

Explanation Explain(const Memory& memory, Encoder& encoder, const ImageView& image,
                    const Recollection& recollection, int runner_up) {
  const Grids grids(encoder);
  Require(static_cast<int>(recollection.answers.size()) == memory.neurons() &&
              recollection.seen_under.empty() == (grids.first.count() == 1),
          "explanation", "the recollection is of another network");
  const bool looked = !recollection.second_look.empty();
  std::optional<DisplacedImage> live;
  if (looked) live = encoder.LookDisplaced(image, grids.closer);
  Explanation why;
  why.columns = encoder.synapses().neurons_x();
  why.rows = encoder.synapses().neurons_y();
  why.winner =
      VotersFor(memory, encoder, live ? &*live : nullptr, recollection, recollection.winner);
  why.runner_up = VotersFor(memory, encoder, live ? &*live : nullptr, recollection, runner_up);
  return why;
}

}  // namespace recollect::wnn
