#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace recollect {

// Intervals of figures over the images of a drive. Neighbouring images err together (one wrong
// place is wrong for metres), so what is drawn with replacement is never single images but blocks:
// segments of the route, or laps (Efron and Tibshirani 1993, chapter 8; Kuensch 1989).

struct Interval {
  double value = 0, low = 0, high = 0;  // unit of the values
};

struct BootstrapOptions {
  int resamples = 1000;
  double level = 0.95;  // of the interval between the percentiles
  std::uint64_t seed = 1;
};

// A figure of a set of values, e.g. their mean.
using Statistic = std::function<double(const std::vector<double>&)>;
double Mean(const std::vector<double>& values);

// statistic(values), and where it lies when blocks are drawn with replacement, as many as there
// are. block[i]: which one values[i] belongs to. Of one block nothing can be told: low = high =
// value. Throws Error for lists of different lengths, no values, and options out of range.
Interval Bootstrap(std::span<const double> values, std::span<const int> block,
                   const Statistic& statistic, const BootstrapOptions& options = {});

// Metres travelled up to each of the positions, in their order.
std::vector<double> DistanceAlong(std::span<const Eigen::Vector3d> positions);

// Number of the segment, `segment_m` metres of road each, that each of the distances lies in.
std::vector<int> RouteSegments(std::span<const double> distance_m, double segment_m);

}  // namespace recollect
