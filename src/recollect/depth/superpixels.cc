#include "recollect/depth/superpixels.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>

namespace recollect::stereo {
namespace {

// For each set of neighbours (bit k: the k-th on the ring, clockwise from above) that belong to a
// pixel's superpixel: may the pixel leave without parting them? They must have exactly one
// 4-connected component on the ring that touches the pixel by a side.
std::array<bool, 256> MayLeave() {
  std::array<bool, 256> may{};
  for (unsigned ring = 0; ring < 256; ++ring) {
    int touching = 0;
    if (ring == 255) {
      may[ring] = false;  // an inner pixel
      continue;
    }
    // Begin behind a gap, so that no component is met in two parts.
    unsigned start = 0;
    while ((ring >> start & 1) != 0) ++start;
    bool inside = false, touches = false;
    for (unsigned i = 1; i <= 8; ++i) {
      const unsigned k = (start + i) % 8;
      inside = (ring >> k & 1) != 0;
      touches = inside && (touches || k % 2 == 0);
      const bool ends = (ring >> ((k + 1) % 8) & 1) == 0;
      if (inside && ends && touches) ++touching;
      if (inside && ends) touches = false;
    }
    may[ring] = touching == 1;
  }
  return may;
}

}  // namespace

Superpixels::Superpixels(const cv::Mat& lab, const cv::Mat& disparity, int count,
                         const SegmentWeights& weights)
    : lab_(lab),
      disparity_(disparity),
      weights_(weights),
      width_(lab.cols),
      height_(lab.rows),
      stride_(lab.cols + 2) {
  const std::ptrdiff_t s = stride_;
  ring_ = {-s, -s + 1, 1, s + 1, s, s - 1, -1, -s - 1};
  side_ = std::max(2.0, std::sqrt(static_cast<double>(lab.total()) / count));
  const int across = std::max(1, static_cast<int>(std::lround(width_ / side_)));
  const int down = std::max(1, static_cast<int>(std::lround(height_ / side_)));
  labels_.assign(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(height_ + 2), -1);
  sums_.resize(static_cast<std::size_t>(across * down));
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const int label = y * down / height_ * across + x * across / width_;
      labels_[Index(x, y)] = label;
      Add(x, y, label, 1);
    }
  }
}

void Superpixels::Add(int x, int y, int label, double sign) {
  Sums& sums = sums_[static_cast<std::size_t>(label)];
  const cv::Vec3b& colour = lab_.at<cv::Vec3b>(y, x);
  sums.count += sign;
  sums.x += sign * x;
  sums.y += sign * y;
  for (int c = 0; c < 3; ++c) sums.colour[static_cast<std::size_t>(c)] += sign * colour[c];
}

bool Superpixels::OnBoundary(std::size_t at) const {
  for (std::size_t k = 0; k < 8; k += 2) {
    const std::int32_t other = labels_[at + static_cast<std::size_t>(ring_[k])];
    if (other >= 0 && other != labels_[at]) return true;
  }
  return false;
}

// Colour, position, disparity and boundary terms (section 3.1 of the paper) of one pixel.
double Superpixels::Energy(int x, int y, int label, const std::vector<Plane>& planes) const {
  const Sums& sums = sums_[static_cast<std::size_t>(label)];
  const double one = 1 / sums.count;
  const cv::Vec3b& colour = lab_.at<cv::Vec3b>(y, x);
  double energy = 0;
  for (int c = 0; c < 3; ++c) {
    const double off = colour[c] - one * sums.colour[static_cast<std::size_t>(c)];
    energy += off * off;
  }
  const double dx = x - one * sums.x, dy = y - one * sums.y;
  energy += weights_.position * (dx * dx + dy * dy) / (side_ * side_);
  const float disparity = disparity_.at<float>(y, x);
  if (!planes.empty() && disparity >= 0) {
    const double off = planes[static_cast<std::size_t>(label)].At(x, y) - disparity;
    energy += weights_.disparity * std::min(off * off, weights_.inlier_px * weights_.inlier_px);
  }
  const std::size_t at = Index(x, y);
  int different = 0;
  for (const std::ptrdiff_t step : ring_) {
    const std::int32_t other = labels_[at + static_cast<std::size_t>(step)];
    different += other >= 0 && other != label ? 1 : 0;
  }
  return energy + weights_.boundary * different;
}

bool Superpixels::MoveBest(int x, int y, const std::vector<Plane>& planes) {
  static const std::array<bool, 256> kMayLeave = MayLeave();
  const std::size_t at = Index(x, y);
  const std::int32_t old = labels_[at];
  unsigned ring = 0;
  for (std::size_t k = 0; k < 8; ++k) {
    if (labels_[at + static_cast<std::size_t>(ring_[k])] == old) ring |= 1U << k;
  }
  if (!kMayLeave[ring]) return false;
  std::int32_t best = old;
  double least = Energy(x, y, old, planes);
  for (std::size_t k = 0; k < 8; k += 2) {
    const std::int32_t other = labels_[at + static_cast<std::size_t>(ring_[k])];
    if (other < 0 || other == old || other == best) continue;
    const double energy = Energy(x, y, other, planes);
    if (energy < least) {
      least = energy;
      best = other;
    }
  }
  if (best == old) return false;
  Add(x, y, old, -1);
  Add(x, y, best, 1);
  labels_[at] = best;
  return true;
}

void Superpixels::Move(const std::vector<Plane>& planes, int rounds) {
  std::deque<std::size_t> queue;
  std::vector<bool> queued(labels_.size(), false);
  const auto enqueue = [&](std::size_t at) {
    if (labels_[at] < 0 || queued[at] || !OnBoundary(at)) return;
    queued[at] = true;
    queue.push_back(at);
  };
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) enqueue(Index(x, y));
  }
  // Means follow each move, so that a cycle of moves is possible: the number of looks is bounded.
  const auto stride = static_cast<std::size_t>(stride_);
  for (std::size_t left = queue.size() * static_cast<std::size_t>(rounds);
       left > 0 && !queue.empty(); --left) {
    const std::size_t at = queue.front();
    queue.pop_front();
    queued[at] = false;
    const int x = static_cast<int>(at % stride) - 1, y = static_cast<int>(at / stride) - 1;
    if (!MoveBest(x, y, planes)) continue;
    enqueue(at);
    for (const std::ptrdiff_t step : ring_) enqueue(at + static_cast<std::size_t>(step));
  }
}

cv::Mat Superpixels::Labels() const {
  cv::Mat labels(height_, width_, CV_32S);
  for (int y = 0; y < height_; ++y) {
    std::memcpy(labels.ptr(y), &labels_[Index(0, y)],
                static_cast<std::size_t>(width_) * sizeof(std::int32_t));
  }
  return labels;
}

}  // namespace recollect::stereo
