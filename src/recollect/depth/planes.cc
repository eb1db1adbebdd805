#include "recollect/depth/planes.h"

#include <algorithm>

namespace recollect::stereo {
namespace {

// Sobel's horizontal gradient, capped and moved to 0 ... 2 * kGradientCap.
std::uint8_t Gradient(const cv::Mat& gray, int x, int y) {
  const int before = std::max(0, x - 1), after = std::min(gray.cols - 1, x + 1);
  int sum = 0;
  for (int k = -1; k <= 1; ++k) {
    const std::uint8_t* row = gray.ptr(std::clamp(y + k, 0, gray.rows - 1));
    sum += (k == 0 ? 2 : 1) * (row[after] - row[before]);
  }
  return static_cast<std::uint8_t>(std::clamp(sum, -kGradientCap, kGradientCap) + kGradientCap);
}

// A bit for each of the 24 neighbours: is it darker than the pixel?
std::uint32_t Census(const cv::Mat& gray, int x, int y) {
  constexpr int kRadius = 2;
  const std::uint8_t centre = gray.ptr(y)[x];
  std::uint32_t bits = 0;
  for (int v = -kRadius; v <= kRadius; ++v) {
    const std::uint8_t* row = gray.ptr(std::clamp(y + v, 0, gray.rows - 1));
    for (int u = -kRadius; u <= kRadius; ++u) {
      if (u == 0 && v == 0) continue;
      bits = bits << 1 | (row[std::clamp(x + u, 0, gray.cols - 1)] < centre ? 1U : 0U);
    }
  }
  return bits;
}

}  // namespace

MatchPlanes::MatchPlanes(const cv::Mat& gray, bool mirror, int extra, ThreadPool& pool)
    : stride_(gray.cols + extra),
      bytes_(static_cast<std::size_t>(gray.rows) * kPlanes * static_cast<std::size_t>(stride_) +
             32) {
  pool.For(gray.rows, 16, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t y = begin; y < end; ++y) Fill(gray, static_cast<int>(y), mirror);
  });
}

PlaneRows MatchPlanes::Row(int y) const {
  PlaneRows rows{};
  for (std::size_t p = 0; p < kPlanes; ++p) {
    rows[p] = bytes_.data() +
              (static_cast<std::size_t>(y) * kPlanes + p) * static_cast<std::size_t>(stride_);
  }
  return rows;
}

void MatchPlanes::Fill(const cv::Mat& gray, int y, bool mirror) {
  const PlaneRows rows = Row(y);
  const auto plane = [&](Plane p) { return const_cast<std::uint8_t*>(rows[p]); };
  const int width = gray.cols;
  std::vector<std::uint8_t> gradient(static_cast<std::size_t>(width) + 2);
  for (int x = 0; x < width; ++x) gradient[static_cast<std::size_t>(x) + 1] = Gradient(gray, x, y);
  gradient.front() = gradient[1];
  gradient.back() = gradient[static_cast<std::size_t>(width)];
  for (int i = 0; i < stride_; ++i) {
    const int x = mirror ? std::max(0, width - 1 - i) : std::min(i, width - 1);
    const auto at = static_cast<std::size_t>(x) + 1;
    const int value = gradient[at];
    const int before = (value + gradient[at - 1]) / 2, after = (value + gradient[at + 1]) / 2;
    plane(kGradient)[i] = static_cast<std::uint8_t>(value);
    plane(kLeast)[i] = static_cast<std::uint8_t>(std::min({value, before, after}));
    plane(kGreatest)[i] = static_cast<std::uint8_t>(std::max({value, before, after}));
    const std::uint32_t census = Census(gray, x, y);
    plane(kCensus0)[i] = static_cast<std::uint8_t>(census);
    plane(kCensus1)[i] = static_cast<std::uint8_t>(census >> 8);
    plane(kCensus2)[i] = static_cast<std::uint8_t>(census >> 16);
  }
}

}  // namespace recollect::stereo
