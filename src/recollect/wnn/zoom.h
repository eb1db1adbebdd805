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

// What a place sees that lies so many places further along the road; below zero: behind.
struct ZoomAlong {
  double places = 0;
  Zoom zoom;
};
// How far a scene is neither larger nor smaller at the place itself, 1 for not at all: by the line
// through the growth that it and the places around it see, `along`. before, next: what those next
// to it on its own lap see; half of what lies between tells how far from a line growth may be.
// Where all is known well it is a half at as much growth as 2.8 places make; where little is,
// further off. 1 where before, next or the place itself is unknown, or all lie at one spot.
double Steady(std::span<const ZoomAlong> along, const Zoom& before, const Zoom& here,
              const Zoom& next);

}  // namespace recollect::wnn
