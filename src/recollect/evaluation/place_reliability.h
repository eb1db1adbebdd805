#pragma once

#include <vector>

namespace recollect {

// Whether of the places told with probability p a share p is right.

struct Told {
  double probability = 0;
  bool right = false;
};

// Of places told with about the same probability.
struct ReliabilityBin {
  int count = 0;
  double said = 0;           // mean probability
  double right = 0;          // share
  double low = 0, high = 1;  // 95 % interval of that share (Wilson's)
};

// By probability, of equal width: [0, 0.1), [0.1, 0.2), ...; those that hold any.
std::vector<ReliabilityBin> BinsOfEqualWidth(const std::vector<Told>& told, int bins = 10);
// By rising probability, of equal count but for one; fewer bins where there are fewer places.
std::vector<ReliabilityBin> BinsOfEqualCount(std::vector<Told> told, int bins = 10);

}  // namespace recollect
