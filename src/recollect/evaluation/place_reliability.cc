#include "recollect/evaluation/place_reliability.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace recollect {
namespace {

ReliabilityBin BinOf(std::span<const Told> told) {
  constexpr double z = 1.96;
  const auto n = static_cast<double>(told.size());
  ReliabilityBin bin;
  bin.count = static_cast<int>(told.size());
  for (const Told& one : told) {
    bin.said += one.probability / n;
    bin.right += (one.right ? 1 : 0) / n;
  }
  const double middle = (bin.right + z * z / (2 * n)) / (1 + z * z / n);
  const double half =
      z * std::sqrt(bin.right * (1 - bin.right) / n + z * z / (4 * n * n)) / (1 + z * z / n);
  bin.low = std::max(0.0, middle - half);
  bin.high = std::min(1.0, middle + half);
  return bin;
}

}  // namespace

std::vector<ReliabilityBin> BinsOfEqualWidth(const std::vector<Told>& told, int bins) {
  std::vector<std::vector<Told>> sorted(static_cast<std::size_t>(bins));
  for (const Told& one : told) {
    const int bin = std::clamp(static_cast<int>(bins * one.probability), 0, bins - 1);
    sorted[static_cast<std::size_t>(bin)].push_back(one);
  }
  std::vector<ReliabilityBin> reliability;
  for (const auto& bin : sorted) {
    if (!bin.empty()) reliability.push_back(BinOf(bin));
  }
  return reliability;
}

std::vector<ReliabilityBin> BinsOfEqualCount(std::vector<Told> told, int bins) {
  // Stable: places told with equal probability stay in the order of the drive.
  std::stable_sort(told.begin(), told.end(),
                   [](const Told& a, const Told& b) { return a.probability < b.probability; });
  std::vector<ReliabilityBin> reliability;
  const auto count = static_cast<std::size_t>(bins);
  for (std::size_t bin = 0; bin < count; ++bin) {
    const std::size_t begin = told.size() * bin / count, end = told.size() * (bin + 1) / count;
    if (begin < end) reliability.push_back(BinOf(std::span(told).subspan(begin, end - begin)));
  }
  return reliability;
}

}  // namespace recollect
