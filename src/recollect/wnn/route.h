#pragma once

#include <span>
#include <vector>

#include "recollect/wnn/committee.h"

namespace recollect::wnn {

// How the places of a map hang together: what is learnt of a road besides its images. Places are
// the labels of a memory, numbered from 0.
struct Route {
  std::vector<int> next;                 // by place: the one ahead on the same lap, -1: none
  std::vector<int> before;               // the one behind it, -1: none
  std::vector<std::vector<int>> beside;  // the same place as other laps or passes have it

  int places() const { return static_cast<int>(next.size()); }
  // Whether b is a, lies beside it, or is one ahead of or behind either.
  bool WithinOne(int a, int b) const;
};

// One lap of so many places, in order.
Route ChainRoute(int places);

// Votes that speak for each place: its own, those of the places beside it, and half of those one
// ahead and one behind. Laps that show one place share its votes; this joins them again.
std::vector<double> Support(const Route& route, std::span<const LabelVotes> histogram);

// What a label stands out by among its neighbours: votes, but where the scene is larger or smaller
// than it showed it (steady, squared, since one image has to tell alone) the camera was elsewhere.
inline double Standing(const LabelVotes& one) { return one.votes * one.steady * one.steady; }

// The place that stands out most (Standing) among that with most support and those within one of
// it. -1 for an empty histogram.
int Supported(const Route& route, std::span<const LabelVotes> histogram);

}  // namespace recollect::wnn
