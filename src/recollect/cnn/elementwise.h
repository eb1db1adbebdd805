#pragma once

#include <cstdint>

namespace recollect::cnn {

struct AdamRates {
  float beta1, beta2, epsilon;
  float gradient_scale;  // gradients are taken times this
  float keep;            // what is left of a parameter after weight decay
  float step;            // learning rate over the first moment's correction
  float root_scale;      // one over the square root of the second moment's correction
};

// One Adam step on `count` values, everything read and written once.
void AdamStep(float* parameter, float* mean, float* square, const float* gradient,
              std::int64_t count, const AdamRates& rates);

// Sum of squares, in double; not finite where a value is not.
double SquareSum(const float* values, std::int64_t count);

// values[i] *= slope where negative.
void Rectify(float* values, std::int64_t count, float slope);

// out[i] = gradient[i], times slope where rectified[i] is negative. Returns the sum of gradient[i]
// * rectified[i] over those: the slope's gradient times the slope.
double RectifyBackward(const float* rectified, const float* gradient, float* out,
                       std::int64_t count, float slope);

// The same of bfloat16 values, given by their bits; sums and products in float. A value that is no
// number stays none.
void RectifyBfloat16(std::uint16_t* values, std::int64_t count, float slope);
double RectifyBackwardBfloat16(const std::uint16_t* rectified, const std::uint16_t* gradient,
                               std::uint16_t* out, std::int64_t count, float slope);

}  // namespace recollect::cnn
