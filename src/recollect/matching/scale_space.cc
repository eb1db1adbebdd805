#include "recollect/matching/scale_space.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "recollect/core/error.h"
#include "recollect/matching/variants.h"

namespace recollect::matching {
namespace {

constexpr int kSmallestSide = 24;       // of an octave's images, pixels
constexpr double kCameraSigma = 0.5;    // that an image comes with, in its pixels
constexpr int kStripes = 8;             // that threads share out
constexpr int kRowsOfTwoThreads = 100;  // smaller images are not worth a second

using Lanes = float __attribute__((vector_size(64)));
constexpr int kLanes = sizeof(Lanes) / sizeof(float);

// Half of a symmetric kernel, its middle first.
std::vector<float> GaussianKernel(double sigma) {
  std::vector<float> half(static_cast<std::size_t>(std::ceil(3 * sigma)) + 1);
  double sum = 0;
  for (std::size_t i = 0; i < half.size(); ++i) {
    const auto x = static_cast<double>(i);
    const double value = std::exp(-x * x / (2 * sigma * sigma));
    half[i] = static_cast<float>(value);
    sum += i == 0 ? value : 2 * value;
  }
  for (float& value : half) value = static_cast<float>(value / sum);
  return half;
}

int Mirrored(int at, int size) { return at < 0 ? -at : at >= size ? 2 * size - 2 - at : at; }

// One row of the result. rows: the 2 radius + 1 around it; padded: room for width + 2 radius.
RECOLLECT_VARIANTS
void BlurRow(const float* const* rows, const float* kernel, int radius, int width, float* padded,
             float* out) {
  const float* const* middle = rows + radius;
  float* inner = padded + radius;
  for (int x = 0;; x = std::min(x + kLanes, width - kLanes)) {
    Lanes sum, above, below;
    std::memcpy(&sum, middle[0] + x, sizeof sum);
    sum *= kernel[0];
    for (int k = 1; k <= radius; ++k) {
      std::memcpy(&above, middle[-k] + x, sizeof above);
      std::memcpy(&below, middle[k] + x, sizeof below);
      sum += kernel[k] * (above + below);
    }
    std::memcpy(inner + x, &sum, sizeof sum);
    if (x == width - kLanes) break;
  }
  for (int k = 1; k <= radius; ++k) {
    inner[-k] = inner[k];
    inner[width - 1 + k] = inner[width - 1 - k];
  }
  for (int x = 0;; x = std::min(x + kLanes, width - kLanes)) {
    Lanes sum, left, right;
    std::memcpy(&sum, inner + x, sizeof sum);
    sum *= kernel[0];
    for (int k = 1; k <= radius; ++k) {
      std::memcpy(&left, inner + x - k, sizeof left);
      std::memcpy(&right, inner + x + k, sizeof right);
      sum += kernel[k] * (left + right);
    }
    std::memcpy(out + x, &sum, sizeof sum);
    if (x == width - kLanes) break;
  }
}

}  // namespace

double SigmaOf(double layer) { return kBaseSigma * std::pow(2.0, layer / kLayers); }

void Blur(const cv::Mat& from, cv::Mat& to, double sigma) {
  const std::vector<float> kernel = GaussianKernel(sigma);
  const int radius = static_cast<int>(kernel.size()) - 1;
  Require(from.type() == CV_32FC1 && from.cols >= kLanes && std::min(from.rows, from.cols) > radius,
          "blur", "needs an image of floats that is larger than its kernel");
  to.create(from.size(), CV_32FC1);
  cv::parallel_for_(
      {0, from.rows},
      [&](const cv::Range& range) {
        std::vector<const float*> rows(2 * kernel.size() - 1);
        std::vector<float> padded(static_cast<std::size_t>(from.cols) + rows.size());
        for (int y = range.start; y < range.end; ++y) {
          for (int k = -radius; k <= radius; ++k) {
            rows[static_cast<std::size_t>(k + radius)] =
                from.ptr<float>(Mirrored(y + k, from.rows));
          }
          BlurRow(rows.data(), kernel.data(), radius, from.cols, padded.data(), to.ptr<float>(y));
        }
      },
      from.rows >= kRowsOfTwoThreads ? kStripes : 1);
}

ScaleSpace::ScaleSpace(const cv::Mat& gray) {
  Require(gray.type() == CV_8UC1 && std::min(gray.cols, gray.rows) >= 32, "scale space",
          "needs a gray image of 8 bits and at least 32 x 32 pixels");
  cv::Mat base;
  gray.convertTo(base, CV_32F);
  cv::resize(base, base, {2 * gray.cols, 2 * gray.rows}, 0, 0, cv::INTER_LINEAR);
  while (std::min(base.cols, base.rows) >= kSmallestSide) {
    auto& images = octaves_.emplace_back();
    if (octaves_.size() == 1) {
      Blur(base, images[0], std::sqrt(kBaseSigma * kBaseSigma - 4 * kCameraSigma * kCameraSigma));
    } else {
      images[0] = base;
    }
    for (int layer = 1; layer < kLayers + 3; ++layer) {
      const double before = SigmaOf(layer - 1), after = SigmaOf(layer);
      const auto at = static_cast<std::size_t>(layer);
      Blur(images[at - 1], images[at], std::sqrt(after * after - before * before));
    }
    base = cv::Mat();
    cv::resize(images[kLayers], base, {images[0].cols / 2, images[0].rows / 2}, 0, 0,
               cv::INTER_NEAREST);
  }
}

}  // namespace recollect::matching
