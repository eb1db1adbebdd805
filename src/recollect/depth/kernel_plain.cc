#include <algorithm>
#include <bit>
#include <cstddef>

#include "recollect/depth/kernel.h"

namespace recollect::stereo {
namespace {

// Birchfield and Tomasi: how far a value is from the range that the other image takes within half a
// pixel, the better of both ways round.
int GradientCost(const PlaneRows& left, const PlaneRows& right, int l, int r) {
  const auto beyond = [](int value, int least, int greatest) {
    return std::max({0, value - greatest, least - value});
  };
  return std::min(beyond(left[kGradient][l], right[kLeast][r], right[kGreatest][r]),
                  beyond(right[kGradient][r], left[kLeast][l], left[kGreatest][l]));
}

void Match(const PlaneRows& left, const PlaneRows& right, int width, int disparities,
           std::uint8_t* costs) {
  for (int x = 0; x < width; ++x) {
    for (int d = 0; d < disparities; ++d) {
      const int r = width - 1 - x + d;
      int cost = kSixths * GradientCost(left, right, x, r);
      for (int plane = kCensus0; plane <= kCensus2; ++plane) {
        const auto p = static_cast<std::size_t>(plane);
        cost += std::popcount(static_cast<std::uint8_t>(left[p][x] ^ right[p][r]));
      }
      *costs++ = static_cast<std::uint8_t>(cost);
    }
  }
}

void Slide(const std::uint8_t* enters, const std::uint8_t* leaves, int count, std::uint16_t* sums) {
  for (int i = 0; i < count; ++i) {
    sums[i] = static_cast<std::uint16_t>(sums[i] + enters[i] - leaves[i]);
  }
}

void Window(const std::uint16_t* sums, int width, int disparities, std::uint16_t* out) {
  for (int x = 0; x < width; ++x) {
    for (int d = 0; d < disparities; ++d) {
      int sum = kSixths / 2;
      for (int k = -kWindowRadius; k <= kWindowRadius; ++k) {
        sum += sums[std::clamp(x + k, 0, width - 1) * disparities + d];
      }
      *out++ = static_cast<std::uint16_t>(sum / kSixths);
    }
  }
}

// One step of a path (Hirschmueller 2008, equation 13). Returns the least of `to`.
std::uint16_t Step(const SweepRow& row, const std::uint16_t* cost, const std::uint16_t* from,
                   std::uint16_t least, std::uint16_t* to, std::uint16_t* sum) {
  std::uint16_t lowest = 0xffff;
  for (int d = 0; d < row.disparities; ++d) {
    const int jump = std::min(from[d - 1], from[d + 1]) + row.small_penalty;
    const int best = std::min({int{from[d]}, jump, least + row.large_penalty});
    to[d] = static_cast<std::uint16_t>(cost[d] + best - least);
    sum[d] = static_cast<std::uint16_t>(sum[d] + to[d]);
    lowest = std::min(lowest, to[d]);
  }
  return lowest;
}

void Sweep(const SweepRow& row) {
  const std::ptrdiff_t stride = row.disparities + kSlotPad;
  auto along = row.along;
  std::uint16_t along_least = 0;
  for (int i = 0; i < row.width; ++i) {
    const int x = row.step > 0 ? i : row.width - 1 - i;
    const std::uint16_t* cost = row.costs + std::ptrdiff_t{x} * row.disparities;
    std::uint16_t* sum = row.sums + std::ptrdiff_t{x} * row.disparities;
    std::fill_n(sum, row.disparities, std::uint16_t{0});
    for (int k = 0; k < kRowPaths; ++k) {
      const auto p = static_cast<std::size_t>(k);
      const int from = x + 1 + row.step * (k - 1);
      row.here_least[p][x + 1] =
          Step(row, cost, row.before[p] + stride * from, row.before_least[p][from],
               row.here[p] + stride * (x + 1), sum);
    }
    along_least = Step(row, cost, along[0], along_least, along[1], sum);
    std::swap(along[0], along[1]);
  }
}

void Winners(std::uint16_t* sums, const std::uint16_t* second, int width, int disparities,
             std::uint16_t* best, std::uint16_t* right_cost, std::uint16_t* right_best) {
  std::fill_n(right_cost, width + disparities, std::uint16_t{0xffff});
  std::fill_n(right_best, width + disparities, std::uint16_t{0});
  for (int x = 0; x < width; ++x, sums += disparities, second += disparities) {
    int winner = 0;
    for (int d = 0; d < disparities; ++d) {
      sums[d] = static_cast<std::uint16_t>(sums[d] + second[d]);
      if (sums[d] < sums[winner]) winner = d;
      const int r = width - 1 - x + d;
      if (sums[d] < right_cost[r]) {
        right_cost[r] = sums[d];
        right_best[r] = static_cast<std::uint16_t>(d);
      }
    }
    best[x] = static_cast<std::uint16_t>(winner);
  }
}

}  // namespace

const Kernel kPlainKernel = {"plain", Match, Slide, Window, Sweep, Winners};

}  // namespace recollect::stereo
