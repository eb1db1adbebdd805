#include "recollect/matching/describe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "recollect/matching/features.h"

namespace recollect::matching {
namespace {

constexpr int kCells = 4, kBins = 8;   // of a descriptor: cells a side, directions a cell
constexpr float kCellSigmas = 3;       // side of a cell, in the point's sigma
constexpr float kReach = kCells + 1;   // side of the patch, in cells
constexpr int kSamples = 20;           // a side of the patch
constexpr float kMostOfOneBin = 0.2f;  // of the descriptor's length, against glare
constexpr float kLength = 320;         // few bins of unit RootSIFT are above 127 / 320

// Along one side: the cell before a sample, its share in the next, and the Gaussian weight.
struct Sampling {
  std::array<float, kSamples> offset{}, next{}, weight{};
  std::array<int, kSamples> cell{};  // from -1; cells -1 and kCells are outside
  Sampling() {
    for (std::size_t i = 0; i < kSamples; ++i) {
      offset[i] = ((static_cast<float>(i) + 0.5f) / kSamples - 0.5f) * kReach;  // in cells
      const float at = offset[i] + kCells / 2 - 0.5f;
      const float below = std::floor(at);
      cell[i] = static_cast<int>(below);
      next[i] = at - below;
      weight[i] = std::exp(-offset[i] * offset[i] / (0.5f * kCells * kCells));
    }
  }
};
const Sampling kSampling;

// A row's samples: length and direction of the gradient, this in bins.
struct Gradients {
  std::array<float, kSamples> dx{}, dy{}, length{}, share{};
  std::array<int, kSamples> bin{};
  // atan2 by octants; within one, atan(r) is about r (pi/4 + 0.273 (1 - r)), off by 0.004 at most.
  void ToPolar() {
    for (std::size_t i = 0; i < kSamples; ++i) {
      const float x = std::abs(dx[i]), y = std::abs(dy[i]);
      const float most = std::max(x, y), least = std::min(x, y);
      const float r = least / std::max(most, 1e-6f);
      float at = r * (1 + 0.3476f * (1 - r));  // 0 .. 1, an octant is a bin
      at = y > x ? 2 - at : at;
      at = dx[i] < 0 ? 4 - at : at;
      at = dy[i] < 0 ? 8 - at : at;
      const float whole = std::floor(at);
      bin[i] = static_cast<int>(whole) & (kBins - 1);
      share[i] = at - whole;
      length[i] = std::sqrt(dx[i] * dx[i] + dy[i] * dy[i]);
    }
  }
};

using Histogram = std::array<float, kDescriptorBytes>;

// blurred: the octave's image at about the point's scale; point and sigma in its pixels.
Histogram Collect(const cv::Mat& blurred, cv::Point2f point, float sigma) {
  const float cell = kCellSigmas * sigma;
  // Cells -1 and kCells, half outside, are summed up, too, and left out.
  std::array<std::array<float, (kCells + 2) * kBins>, kCells + 2> sums{};
  Gradients row;
  for (std::size_t j = 0; j < kSamples; ++j) {
    const int y = static_cast<int>(std::lround(point.y + kSampling.offset[j] * cell));
    if (y < 1 || y >= blurred.rows - 1) continue;
    const float* here = blurred.ptr<float>(y);
    const float *above = blurred.ptr<float>(y - 1), *below = blurred.ptr<float>(y + 1);
    for (std::size_t i = 0; i < kSamples; ++i) {
      const int x = static_cast<int>(std::lround(point.x + kSampling.offset[i] * cell));
      const bool inside = x >= 1 && x < blurred.cols - 1;
      row.dx[i] = inside ? here[x + 1] - here[x - 1] : 0;
      row.dy[i] = inside ? above[x] - below[x] : 0;
    }
    row.ToPolar();
    std::array<float, (kCells + 2) * kBins> line{};
    for (std::size_t i = 0; i < kSamples; ++i) {
      const float weight = row.length[i] * kSampling.weight[i];
      const float right = weight * kSampling.next[i], left = weight - right;
      float* cells = line.data() + (kSampling.cell[i] + 1) * kBins;
      const int bin = row.bin[i], after = (bin + 1) & (kBins - 1);
      cells[bin] += left * (1 - row.share[i]);
      cells[after] += left * row.share[i];
      cells[kBins + bin] += right * (1 - row.share[i]);
      cells[kBins + after] += right * row.share[i];
    }
    const float lower = kSampling.weight[j] * kSampling.next[j];
    const float upper = kSampling.weight[j] - lower;
    auto& first = sums[static_cast<std::size_t>(kSampling.cell[j] + 1)];
    auto& second = sums[static_cast<std::size_t>(kSampling.cell[j] + 2)];
    for (std::size_t k = 0; k < line.size(); ++k) {
      first[k] += upper * line[k];
      second[k] += lower * line[k];
    }
  }
  Histogram result;
  auto to = result.begin();
  for (std::size_t y = 1; y <= kCells; ++y) {
    to = std::copy_n(sums[y].begin() + kBins, kCells * kBins, to);
  }
  return result;
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

// In stripes: a filter reads beyond the rows that it writes.
void Blur(const cv::Mat& from, cv::Mat& to, double sigma) {
  to.create(from.size(), from.type());
  const int side = 2 * static_cast<int>(std::ceil(3 * sigma)) + 1;
  cv::parallel_for_(
      {0, from.rows},
      [&](const cv::Range& rows) {
        cv::Mat stripe = to.rowRange(rows);
        cv::GaussianBlur(from.rowRange(rows), stripe, {side, side}, sigma, sigma);
      },
      from.rows >= 128 ? 2 : 1);
}

int Octave(const cv::KeyPoint& point) { return static_cast<std::int8_t>(point.octave & 255); }
int Layer(const cv::KeyPoint& point) { return (point.octave >> 8) & 255; }

// The blurred images that the points were found in, as cv::SIFT makes them: octave -1 has twice
// the image's pixels a side.
class ScaleSpace {
 public:
  ScaleSpace(const cv::Mat& gray, int last_octave) {
    cv::Mat base;
    gray.convertTo(base, CV_32F);
    cv::resize(base, base, {2 * gray.cols, 2 * gray.rows}, 0, 0, cv::INTER_LINEAR);
    constexpr double kCameraSigma = 2 * 0.5;  // of the image as it comes, in the doubled one
    Blur(base, levels_.emplace_back(),
         std::sqrt(kBaseSigma * kBaseSigma - kCameraSigma * kCameraSigma));
    const double step = std::pow(2.0, 1.0 / kLayers);
    for (int octave = -1; octave <= last_octave; ++octave) {
      if (octave >= 0) {
        const cv::Mat& double_sigma = levels_.back();
        cv::resize(double_sigma, base, {double_sigma.cols / 2, double_sigma.rows / 2}, 0, 0,
                   cv::INTER_NEAREST);
        levels_.push_back(base.clone());
      }
      for (int layer = 1; layer <= kLayers; ++layer) {
        const double before = kBaseSigma * std::pow(step, layer - 1);
        const cv::Mat last = levels_.back();
        Blur(last, levels_.emplace_back(), before * std::sqrt(step * step - 1));
      }
    }
  }
  const cv::Mat& At(int octave, int layer) const {
    return levels_[static_cast<std::size_t>((octave + 1) * (kLayers + 1) + layer)];
  }

 private:
  std::vector<cv::Mat> levels_;  // layers 0 to kLayers of each octave
};

}  // namespace

std::vector<std::int8_t> Describe(const cv::Mat& gray, const std::vector<cv::KeyPoint>& points) {
  std::vector<std::int8_t> descriptors(points.size() * kDescriptorBytes);
  if (points.empty()) return descriptors;
  int last = -1;
  for (const cv::KeyPoint& point : points) last = std::max(last, Octave(point));
  const ScaleSpace space(gray, last);
  cv::parallel_for_({0, static_cast<int>(points.size())}, [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) {
      const cv::KeyPoint& point = points[static_cast<std::size_t>(i)];
      const float scale = std::ldexp(1.0f, -Octave(point));
      Histogram histogram = Collect(space.At(Octave(point), Layer(point)), point.pt * scale,
                                    0.5f * point.size * scale);
      Quantise(histogram, descriptors.data() + static_cast<std::ptrdiff_t>(i) * kDescriptorBytes);
    }
  });
  return descriptors;
}

}  // namespace recollect::matching
