#pragma once

#include <span>
#include <vector>

#include "recollect/wnn/closer_look.h"
#include "recollect/wnn/committee.h"
#include "recollect/wnn/network.h"

namespace recollect::wnn {

// Ahead of a key frame's place an image shows the scene larger than it does, behind it smaller, and
// beside it neither: there walls only move sideways. How parts of an image are displaced tells
// which. See docs/recognition.md, "Neither larger nor smaller".

// Where a part of the image lies: from the middle of the window, in halves of its width.
struct PartCentre {
  double x = 0, y = 0;
};
// By part. parts: by neuron, as Encoder::parts.
std::vector<PartCentre> PartCentres(const Synapses& synapses, std::span<const int> parts);

// From the parts' displacements and votes; `grid`: of these displacements.
Zoom ZoomOf(const Look& look, std::span<const PartCentre> centres, const Displacements& grid);

// How far a place shows the scene neither larger nor smaller, 1 for not at all: by the line through
// the growth that it and the places before and after it see, in the order of the route. Where all
// is known well it is a half at as much growth as 2.8 places make; where little is, further off. 1
// where the place, the one before or the one after is unknown.
constexpr int kBeside = 2;
double Steady(const Zoom (&along)[2 * kBeside + 1]);

}  // namespace recollect::wnn
