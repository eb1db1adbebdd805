#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

namespace recollect {

// How far another visit to a place may differ from the first, for trials where there has been no
// other visit. Each draws evenly from its range.
struct Perturbation {
  double turn_deg = 3;    // roll, either way
  double scale = 0.08;    // zoom, either way, as a share
  double shift_x = 0.07;  // either way, as a share of the width
  double shift_y = 0.03;
  double gamma = 0.5;  // exp of it either way
  double gain = 0.4;   // exp of it either way
  double shade = 0.5;  // gain from one side of the image to the other, either way
  double tint = 0.15;  // of blue and red, either way
  double noise = 4;    // gray levels, standard deviation
  double cover = 0.2;  // side of a rectangle put before the scene, at most, as a share
};

// The image (8-bit B, G, R) as another visit might see it.
cv::Mat Perturbed(const cv::Mat& image, std::uint64_t seed, const Perturbation& by = {});

}  // namespace recollect
