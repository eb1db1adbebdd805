#pragma once

#include <opencv2/core/mat.hpp>

#include "recollect/core/random.h"

namespace recollect::cnn {

// The same view in another light, by another exposure: gain from dusk to glare, gamma, contrast,
// white balance, saturation, light that falls off to one side, blur and noise, all at random.
// rows x cols of 8-bit B, G, R, in and out; nothing moves, so the pair's pose stays true.
cv::Mat AugmentLight(const cv::Mat& image, Random& random);

}  // namespace recollect::cnn
