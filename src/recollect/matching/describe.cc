#include "recollect/matching/describe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <opencv2/core/utility.hpp>

#include "recollect/matching/features.h"
#include "recollect/matching/variants.h"

namespace recollect::matching {
namespace {

constexpr int kCells = 4, kBins = 8;  // of a descriptor: cells a side, directions a cell
constexpr float kCellSigmas = 3;      // side of a cell, in the point's sigma
constexpr int kReach = kCells + 1;    // side of the patch, in cells: a half on either side
constexpr int kCellSamples = 4;       // a side of a cell
constexpr int kSamples = kReach * kCellSamples;
constexpr float kMostOfOneBin = 0.2f;  // of the descriptor's length, against glare
constexpr float kLength = 320;         // few bins of unit RootSIFT are above 127 / 320

// Along one side. The first kCellSamples lie between the middles of cells -1 and 0, the next of
// cells 0 and 1, and so on; cells -1 and kCells are outside.
struct Sampling {
  std::array<float, kSamples> offset{}, weight{};  // in cells from the point; Gaussian
  std::array<float, kCellSamples> next{};          // share of the later cell
  Sampling() {
    for (std::size_t i = 0; i < kSamples; ++i) {
      offset[i] = (static_cast<float>(i) + 0.5f) / kCellSamples - 0.5f * kReach;
      weight[i] = std::exp(-offset[i] * offset[i] / (0.5f * kCells * kCells));
    }
    for (std::size_t i = 0; i < kCellSamples; ++i) {
      next[i] = (static_cast<float>(i) + 0.5f) / kCellSamples;
    }
  }
};
const Sampling kSampling;

// A row's samples: length and direction of the gradient, this in bins.
struct Gradients {
  std::array<float, kSamples> dx{}, dy{}, length{}, direction{};
  // atan2 by octants; within one, atan(r) is about r (pi/4 + 0.273 (1 - r)), off by 0.004 at most.
  void ToPolar() {
    for (std::size_t i = 0; i < kSamples; ++i) {
      const float x = std::abs(dx[i]), y = std::abs(dy[i]);
      const float most = std::max(x, y), least = std::min(x, y);
      const float r = least / std::max(most, 1e-6f);
      float at = r * (1 + 0.3476f * (1 - r));  // 0 .. 1, an octant is a bin
      at = y > x ? 2 - at : at;
      at = dx[i] < 0 ? 4 - at : at;
      direction[i] = dy[i] < 0 ? 8 - at : at;
      length[i] = std::sqrt(dx[i] * dx[i] + dy[i] * dy[i]);
    }
  }
};

using Histogram = std::array<float, kDescriptorBytes>;
using Bins = float __attribute__((vector_size(kBins * sizeof(float))));  // of one cell
constexpr Bins kBinMiddles = {0, 1, 2, 3, 4, 5, 6, 7};

// blurred: the octave's image at about the point's scale.
RECOLLECT_VARIANTS
void Collect(const cv::Mat& blurred, const ScalePoint& point, Histogram& histogram) {
  const float cell = kCellSigmas * point.sigma;
  std::array<int, kSamples> columns;
  std::array<float, kSamples> weights = kSampling.weight;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const int x = static_cast<int>(std::floor(point.x + kSampling.offset[i] * cell + 0.5f));
    if (x < 1 || x >= blurred.cols - 1) weights[i] = 0;
    columns[i] = std::clamp(x, 1, blurred.cols - 2);
  }
  Bins sums[kCells + 2][kCells + 2] = {};  // from cell -1
  Gradients row;
  for (std::size_t j = 0; j < kSamples; ++j) {
    const int y = static_cast<int>(std::floor(point.y + kSampling.offset[j] * cell + 0.5f));
    if (y < 1 || y >= blurred.rows - 1) continue;
    const float* here = blurred.ptr<float>(y);
    const float *above = blurred.ptr<float>(y - 1), *below = blurred.ptr<float>(y + 1);
    for (std::size_t i = 0; i < kSamples; ++i) {
      const int x = columns[i];
      row.dx[i] = here[x + 1] - here[x - 1];
      row.dy[i] = above[x] - below[x];
    }
    row.ToPolar();
    const float lower = kSampling.weight[j] * kSampling.next[j % kCellSamples];
    const float upper = kSampling.weight[j] - lower;
    Bins* first = sums[j / kCellSamples];
    Bins* second = sums[j / kCellSamples + 1];
    for (std::size_t c = 0; c < kReach; ++c) {
      Bins left = {}, right = {};
      for (std::size_t k = 0; k < kCellSamples; ++k) {
        const std::size_t i = c * kCellSamples + k;
        // Shared out between the two bins next to the direction, going round.
        Bins apart = row.direction[i] - kBinMiddles;
        apart = apart < 0 ? -apart : apart;
        apart = apart > kBins / 2 ? kBins - apart : apart;
        const Bins part = apart < 1 ? (row.length[i] * weights[i]) * (1 - apart) : Bins{};
        right += kSampling.next[k] * part;
        left += (1 - kSampling.next[k]) * part;
      }
      first[c] += upper * left;
      first[c + 1] += upper * right;
      second[c] += lower * left;
      second[c + 1] += lower * right;
    }
  }
  float* to = histogram.data();
  for (int y = 1; y <= kCells; ++y, to += kCells * kBins) {
    std::memcpy(to, &sums[y][1], sizeof(float) * kCells * kBins);
  }
}

void Quantise(Histogram& histogram, std::int8_t* out) {
  float squares = 0;
  for (const float value : histogram) squares += value * value;
  const float most = kMostOfOneBin * std::sqrt(squares);
  float sum = 1e-6f;
  for (float& value : histogram) sum += value = std::min(value, most);
  for (std::size_t k = 0; k < histogram.size(); ++k) {
    const auto byte = static_cast<int>(kLength * std::sqrt(histogram[k] / sum) + 0.5f);
    out[k] = static_cast<std::int8_t>(std::min(127, byte));
  }
}

}  // namespace

std::vector<std::int8_t> Describe(const ScaleSpace& space, std::span<const ScalePoint> points) {
  std::vector<std::int8_t> descriptors(points.size() * kDescriptorBytes);
  cv::parallel_for_({0, static_cast<int>(points.size())}, [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) {
      const ScalePoint& point = points[static_cast<std::size_t>(i)];
      Histogram histogram;
      Collect(space.At(point.octave, point.layer), point, histogram);
      Quantise(histogram, descriptors.data() + static_cast<std::ptrdiff_t>(i) * kDescriptorBytes);
    }
  });
  return descriptors;
}

}  // namespace recollect::matching
