#pragma once

#include <opencv2/core/mat.hpp>

#include "recollect/simulation/day.h"
#include "recollect/simulation/renderer.h"

namespace recollect::simulation {

// How the camera turns light into a picture. Differs a little from day to day.
struct Film {
  float brightness = 0.20F;  // the automatic exposure's mean level, linear
  float longest_gain = 3;    // more light than this the exposure cannot make: dusk stays dark
  Color white_balance = Color::Ones();
  float gamma = 2.2F;
  float vignette = 0.25F;      // light lost in the corners
  float shot_noise = 0.012F;   // standard deviation at full white, linear
  float read_noise = 0.0025F;  // in black
  double exposure = 0.004;     // seconds the shutter is open
};

// The camera's settings on a day; with the light switched off, always the same.
Film LoadFilm(const Day& day);

// What becomes of a rendering: blurred by the camera's motion during the exposure
// (`start_from_end`: camera at its end relative to its start), exposed, noisy; 8-bit B, G, R.
// `extra_gain` multiplies the automatic exposure. The same seed gives the same grain.
cv::Mat Develop(const Rendering& rendering, const PinholeCamera& camera, const SE3& start_from_end,
                const Film& film, std::uint64_t seed, float extra_gain = 1);

// Depth as kept in files: every `step`-th pixel of every `step`-th row, centimetres, 16 bits;
// 0 for the sky and from 200 m on.
cv::Mat DepthImage(const Rendering& rendering, int step);

}  // namespace recollect::simulation
