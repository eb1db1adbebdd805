#pragma once

#include <cstddef>
#include <vector>

namespace recollect {

// What a table says of a set of errors; the unit is that of the values.
struct Summary {
  std::size_t count = 0;
  double mean = 0, median = 0, p75 = 0, p95 = 0, max = 0;
};

// The value below which a share q in [0, 1] of the values lies, interpolated linearly between
// neighbours (NumPy's default); 0 for no values. NaN is refused with an Error.
double Quantile(std::vector<double> values, double q);

Summary Summarise(const std::vector<double>& values);

// What a box plot draws: quartiles, and whiskers to the outermost values that are no further from
// the box than one and a half times its length (Tukey 1977). All zero for no values.
struct Box {
  double low = 0, q1 = 0, median = 0, q3 = 0, high = 0;
};
Box BoxOf(const std::vector<double>& values);

}  // namespace recollect
