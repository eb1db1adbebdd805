#pragma once

#include <vector>

#include "recollect/matching/scale_space.h"

namespace recollect::matching {

// A blob, darker or brighter than what is around it.
struct ScalePoint {
  int octave = 0, layer = 0;  // the image of the scale space nearest to its scale
  float x = 0, y = 0;         // in the octave's pixels, to fractions of one
  float sigma = 0;            // its scale, in the octave's pixels
  float contrast = 0;         // of the differences of Gaussians, 0 to 1
};

// Extrema of the differences of Gaussians over place and scale, interpolated, without those that
// are weaker than `contrast` or lie along an edge (Lowe 2004, sections 3 and 4; ratio of curvatures
// below ten). Strongest first, the same on every run.
std::vector<ScalePoint> FindPoints(const ScaleSpace& space, double contrast);

}  // namespace recollect::matching
