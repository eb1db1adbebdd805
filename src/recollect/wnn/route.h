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
  // Those at most kAlong places further along the road or behind, of any lap, the place itself
  // among them.
  struct Along {
    int place = 0;
    double places = 0;  // further along
  };
  static constexpr double kAlong = 2.2;
  std::vector<std::vector<Along>> along;

  int places() const { return static_cast<int>(next.size()); }
  // Whether b is a, lies beside it, or is one ahead of or behind either.
  bool WithinOne(int a, int b) const;
};

// One lap of so many places, in order.
Route ChainRoute(int places);

// Votes that speak for each place: its own, those of the places beside it, and half of those one
// ahead and one behind. Laps that show one place share its votes; this joins them again.
std::vector<double> Support(const Route& route, std::span<const LabelVotes> histogram);

// By entry of the histogram, how steady its place is, given those along the road (Steady).
std::vector<double> Steadiness(const Route& route, std::span<const LabelVotes> histogram);

// Of a place and those within one of it, the one that stands out: that has most votes times
// steadiness squared, since one image has to tell alone, times the twentieth root of what is
// believed of it (by place; nothing is by default). The place itself where none has votes.
int Outstanding(const Route& route, int place, std::span<const LabelVotes> histogram,
                std::span<const double> belief = {});

// Outstanding about the place with most support. -1 for an empty histogram.
int Supported(const Route& route, std::span<const LabelVotes> histogram);

}  // namespace recollect::wnn
