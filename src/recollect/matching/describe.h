#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "recollect/matching/points.h"

namespace recollect::matching {

// Upright SIFT descriptors (Lowe 2004, section 6) as RootSIFT (Arandjelovic and Zisserman 2012),
// kDescriptorBytes of 0 to 127 each. A patch is sampled at as many places whatever its scale: its
// blur grows with it, so that no more are needed.
std::vector<std::int8_t> Describe(const ScaleSpace& space, std::span<const ScalePoint> points);

}  // namespace recollect::matching
