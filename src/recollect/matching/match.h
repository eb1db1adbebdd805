#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace recollect::matching {

// Feature `live` of the live image looks like landmark `mapped`.
struct Match {
  int live = 0, mapped = 0;
  int likeness = 0;  // of their descriptors, see Likeness
};

struct MatchOptions {
  double ratio = 0.85;  // distance to the best over that to the second (Lowe 2004) must be below
};

// Inner product of two descriptors (kDescriptorBytes each); Distance is between them.
int Likeness(const std::int8_t* a, const std::int8_t* b);
// Of one with each of `others`, numbers of descriptors that lie one after the other.
void Likenesses(const std::int8_t* one, const std::int8_t* descriptors, std::span<const int> others,
                int* out);
double Distance(int likeness, int norm2_a, int norm2_b);

// Pairs that are each other's most alike and pass the ratio test on the live side. Descriptors lie
// one after the other. In order of `live`.
std::vector<Match> MatchDescriptors(const std::int8_t* live, int live_count,
                                    const std::int8_t* mapped, int mapped_count,
                                    const MatchOptions& options = {});

}  // namespace recollect::matching
