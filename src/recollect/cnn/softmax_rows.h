#pragma once

#include <cstdint>

namespace recollect::cnn {

// Of a row of `count` scores, at least one. Float is done in vectors, exp within 2 units in the
// last place (scores 87 below the greatest count as that far below); it may differ in the last bit
// between processors, never between numbers of threads. Double is plain, for checking gradients.

// The greatest, and in `best` where it stands first.
float Greatest(const float* scores, std::int64_t count, std::int64_t* best);
double Greatest(const double* scores, std::int64_t count, std::int64_t* best);

// log sum exp(scores), `greatest` the greatest of them. `scores` is left as it is.
float LogSumExp(const float* scores, std::int64_t count, float greatest);
double LogSumExp(const double* scores, std::int64_t count, double greatest);

// scores[i] = scale * exp(scores[i] - total).
void ScaledSoftmax(float* scores, std::int64_t count, float total, float scale);
void ScaledSoftmax(double* scores, std::int64_t count, double total, double scale);

}  // namespace recollect::cnn
