#pragma once

#include <cstddef>
#include <span>

#include "recollect/dataset/lap.h"
#include "recollect/matching/features.h"
#include "recollect/matching/landmarks.h"

namespace recollect::matching {

struct LandmarkOptions {
  int count = 400;                   // kept of a key frame, at most
  FeatureOptions features{1200};     // to choose from
  double baselines_m[2] = {1, 2.5};  // how far away the neighbours are, before and behind
  double nearest_m = 1, farthest_m = 150;
  double depth_error = 0.005;  // of the depth images, relative
  int min_sightings = 2;       // in neighbours, of a point without depth image
};

// A sighting of a key frame's point in another image whose pose is known.
struct Sighting {
  SE3 other_from_keyframe;
  Eigen::Vector2d pixel;
  double pixel_sigma = 1;
};

// Depth along z of what `pixel` of the key frame shows, by least squares over inverse depth with
// Cauchy's loss.
struct Triangulated {
  double depth = 0;          // metres
  double inverse_sigma = 0;  // of 1 / depth
  int supports = 0;          // sightings within three standard deviations
};

// prior_depth: 0 for none, else of a depth image, with prior_inverse_sigma of its inverse. Depths
// outside [nearest, farthest] are not looked at. depth is 0 where nothing is known.
Triangulated TriangulateDepth(const PinholeCamera& camera, const Eigen::Vector2d& pixel,
                              std::span<const Sighting> sightings, double prior_depth,
                              double prior_inverse_sigma, double nearest_m, double farthest_m);

// Features of a frame with their depth: from its depth image where there is one, and from the
// frames before and behind it with their known poses, which also show what moves by itself and what
// can be found again. Without depth images the lap must move: a place where it stands has none.
// Throws Error where images cannot be read.
Landmarks MakeLandmarks(const Lap& lap, std::size_t frame, const LandmarkOptions& options = {});

// Standard deviation of where a feature of that size is found, pixels.
double PixelSigma(double size);

}  // namespace recollect::matching
