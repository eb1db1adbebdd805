#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>

namespace recollect {

// How far another visit to a place may differ from the first, for trials where there has been no
// other visit. Each draws evenly from its range. So far that some images are not recognised: where
// all are, nothing is learnt of what wrong answers look like.
struct Perturbation {
  double turn_deg = 4.5;  // roll, either way
  double scale = 0.18;    // zoom, either way, as a share
  double shift_x = 0.13;  // either way, as a share of the width
  double shift_y = 0.045;
  double shear = 0.12;  // sideways by so much of the height above or below the middle: what is
                        // near moves more than what is far
  double gamma = 0.75;  // exp of it either way
  double gain = 0.6;    // exp of it either way
  double shade = 0.75;  // gain from one side of the image to the other, either way
  double tint = 0.2;    // of blue and red, either way
  double bend = 0.35;   // of the half left of the middle wider by so much, and of the other
                        // narrower: what walls do when one goes nearer to one of them
  double blur = 0.009;  // standard deviation at most, as a share of the width
  double noise = 6;     // gray levels, standard deviation
  double cover = 0.35;  // side of a rectangle put before the scene, at most, as a share
};

// One visit: where in each range it lies, from 0 to 1, in no order that matters to others.
struct Visit {
  std::array<double, 20> at{};
};

Visit DrawVisit(std::uint64_t seed);
// Visits along a way: what differs at one place does so at the next ones, too. It changes from one
// drawn visit to the next within `length` places.
Visit VisitAlong(std::uint64_t seed, int place, int length);

// The image (8-bit B, G, R) as that visit sees it. seed: of the noise.
cv::Mat Perturbed(const cv::Mat& image, const Visit& visit, std::uint64_t seed,
                  const Perturbation& by = {});
// As any other visit might see it.
cv::Mat Perturbed(const cv::Mat& image, std::uint64_t seed, const Perturbation& by = {});

}  // namespace recollect
