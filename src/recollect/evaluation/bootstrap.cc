#include "recollect/evaluation/bootstrap.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "recollect/core/error.h"
#include "recollect/core/random.h"
#include "recollect/evaluation/statistics.h"

namespace recollect {

double Mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

Interval Bootstrap(std::span<const double> values, std::span<const int> block,
                   const Statistic& statistic, const BootstrapOptions& options) {
  Require(!values.empty() && values.size() == block.size(), "bootstrap",
          fmt::format("{} values in {} places", values.size(), block.size()));
  Require(options.resamples > 0 && options.level > 0 && options.level < 1, "bootstrap",
          "wants a resample at least and a level between 0 and 1");
  std::map<int, std::vector<double>> by_number;
  for (std::size_t i = 0; i < values.size(); ++i) by_number[block[i]].push_back(values[i]);
  std::vector<std::vector<double>> blocks;
  for (auto& [number, members] : by_number) blocks.push_back(std::move(members));

  const double value = statistic({values.begin(), values.end()});
  if (blocks.size() == 1) return {value, value, value};
  Random random(options.seed);
  std::vector<double> figures, drawn;
  for (int resample = 0; resample < options.resamples; ++resample) {
    drawn.clear();
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      const auto chosen =
          static_cast<std::size_t>(random.Index(static_cast<std::int64_t>(blocks.size())));
      drawn.insert(drawn.end(), blocks[chosen].begin(), blocks[chosen].end());
    }
    figures.push_back(statistic(drawn));
  }
  const double tail = (1 - options.level) / 2;
  return {value, Quantile(figures, tail), Quantile(figures, 1 - tail)};
}

std::vector<double> DistanceAlong(std::span<const Eigen::Vector3d> positions) {
  std::vector<double> distance(positions.size(), 0);
  for (std::size_t i = 1; i < positions.size(); ++i) {
    distance[i] = distance[i - 1] + (positions[i] - positions[i - 1]).norm();
  }
  return distance;
}

std::vector<int> RouteSegments(std::span<const double> distance_m, double segment_m) {
  Require(segment_m > 0, "route segments", fmt::format("{} m is not positive", segment_m));
  std::vector<int> segments;
  for (const double metres : distance_m) {
    segments.push_back(static_cast<int>(std::floor(metres / segment_m)));
  }
  return segments;
}

}  // namespace recollect
