#pragma once

#include <limits>
#include <span>
#include <vector>

#include "recollect/wnn/closer_look.h"
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

// What an entry shows has grown so far at the window's edge in the live image, in pixels of a 640
// pixels wide one; below zero: it has shrunk.
struct Zoom {
  double growth = 0;
  double variance = std::numeric_limits<double>::infinity();  // as if parts erred each by itself
};
// From the parts' displacements and votes; `grid`: of these displacements.
Zoom ZoomOf(const Look& look, std::span<const PartCentre> centres, const Displacements& grid);

// By label, how far it is neither larger nor smaller there, given what its neighbours say, too: 1
// for not at all, or nothing known of it. labels: rising; one zoom each.
std::vector<double> Steadiness(std::span<const int> labels, std::span<const Zoom> zooms);

}  // namespace recollect::wnn
