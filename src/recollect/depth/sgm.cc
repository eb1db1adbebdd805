#include "recollect/depth/sgm.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <opencv2/calib3d.hpp>
#include <vector>

#include "recollect/core/error.h"
#include "recollect/depth/kernel.h"
#include "recollect/depth/planes.h"

namespace recollect::stereo {
namespace {

constexpr int kBand = 32;            // rows whose costs are summed together
constexpr std::int16_t kPixel = 16;  // speckles are looked for in sixteenths of a pixel
using Words = std::vector<std::uint16_t>;

std::size_t Size(std::ptrdiff_t a, std::ptrdiff_t b) { return static_cast<std::size_t>(a * b); }

// Slots and minima of the paths that come from the row before; see SweepRow.
struct PathRow {
  std::array<Words, kRowPaths> slots, least;

  PathRow(int width, std::ptrdiff_t stride) {
    for (Words& words : slots) words.assign(Size(width + 2, stride) + kSlotPad, 0);
    for (Words& words : least) words.assign(static_cast<std::size_t>(width) + 2, 0);
    for (Words& words : slots) MarkGaps(words, stride);
  }
  static void MarkGaps(Words& words, std::ptrdiff_t stride) {
    for (std::ptrdiff_t gap = 0; gap < std::ssize(words); gap += stride) {
      std::fill_n(words.begin() + gap, kSlotPad, std::uint16_t{0xffff});
    }
  }
};

}  // namespace

void CheckOptions(const SgmOptions& options) {
  Require(options.disparities >= 16 && options.disparities <= 256 && options.disparities % 16 == 0,
          "disparities",
          fmt::format("{} is no multiple of 16 from 16 to 256", options.disparities));
  // With at most 850 for a window, eight paths stay within 16 bits.
  Require(options.small_penalty >= 0 && options.small_penalty <= options.large_penalty &&
              options.large_penalty <= 7000,
          "penalties", "must be 0 <= small <= large <= 7000");
  Require(options.consistency >= -1, "consistency", "must be -1 (no check) or more");
  Require(options.speckle_size >= 0 && options.speckle_step >= 0, "speckles",
          "size and step must not be negative");
}

struct SemiGlobalMatcher::State {
  SgmOptions options;
  ThreadPool& pool;
  const Kernel& kernel;
  int width = 0, height = 0;
  Words costs;                  // [row][pixel][disparity]
  std::array<Words, 2> sweeps;  // the same: sums over four paths each

  std::ptrdiff_t RowSize() const { return std::ptrdiff_t{width} * options.disparities; }
  void Costs(const MatchPlanes& left, const MatchPlanes& right, int begin, int end);
  void Sweep(bool down);
  void Winners(int y, cv::Mat& disparity);
};

// Costs of the rows [begin, end), summed over windows.
void SemiGlobalMatcher::State::Costs(const MatchPlanes& left, const MatchPlanes& right, int begin,
                                     int end) {
  constexpr int kRows = 2 * kWindowRadius + 1;
  const auto size = static_cast<std::size_t>(RowSize());
  std::array<std::vector<std::uint8_t>, kRows> rows;
  for (auto& row : rows) row.assign(size, 0);
  Words sums(size, 0);
  const auto clamped = [&](int y) { return std::clamp(y, 0, height - 1); };
  for (int y = begin - kWindowRadius; y < end + kWindowRadius; ++y) {
    // The new row takes the place of the one that leaves the window, once that is subtracted.
    auto& slot = rows[static_cast<std::size_t>((y - begin + kWindowRadius) % kRows)];
    const std::vector<std::uint8_t> leaves = slot;
    kernel.match(left.Row(clamped(y)), right.Row(clamped(y)), width, options.disparities,
                 slot.data());
    kernel.slide(slot.data(), leaves.data(), static_cast<int>(size), sums.data());
    const int centre = y - kWindowRadius;
    if (centre >= begin) {
      kernel.window(sums.data(), width, options.disparities, costs.data() + centre * RowSize());
    }
  }
}

// The four paths that come from the left and from above, or from the right and from below.
void SemiGlobalMatcher::State::Sweep(bool down) {
  const std::ptrdiff_t stride = options.disparities + kSlotPad;
  PathRow before(width, stride), here(width, stride);
  std::array<Words, 2> along;
  for (int i = 0; i < height; ++i) {
    const int y = down ? i : height - 1 - i;
    SweepRow row;
    row.width = width;
    row.disparities = options.disparities;
    row.step = down ? 1 : -1;
    row.small_penalty = static_cast<std::uint16_t>(options.small_penalty);
    row.large_penalty = static_cast<std::uint16_t>(options.large_penalty);
    row.costs = costs.data() + y * RowSize();
    row.sums = sweeps[down ? 0 : 1].data() + y * RowSize();
    for (std::size_t k = 0; k < kRowPaths; ++k) {
      row.before[k] = before.slots[k].data() + kSlotPad;
      row.here[k] = here.slots[k].data() + kSlotPad;
      row.before_least[k] = before.least[k].data();
      row.here_least[k] = here.least[k].data();
    }
    for (std::size_t k = 0; k < 2; ++k) {
      along[k].assign(static_cast<std::size_t>(stride + kSlotPad), 0);
      PathRow::MarkGaps(along[k], stride);
      row.along[k] = along[k].data() + kSlotPad;
    }
    kernel.sweep(row);
    std::swap(before, here);
  }
}

void SemiGlobalMatcher::State::Winners(int y, cv::Mat& disparity) {
  const auto D = options.disparities;
  Words best(static_cast<std::size_t>(width));
  Words right_cost(static_cast<std::size_t>(width + D)), right_best(right_cost.size());
  std::uint16_t* sums = sweeps[0].data() + y * RowSize();
  kernel.winners(sums, sweeps[1].data() + y * RowSize(), width, D, best.data(), right_cost.data(),
                 right_best.data());
  float* out = disparity.ptr<float>(y);
  for (int x = 0; x < width; ++x) {
    const int d = best[static_cast<std::size_t>(x)];
    const int back = d > x ? -1 : right_best[static_cast<std::size_t>(width - 1 - x + d)];
    const bool consistent =
        options.consistency < 0 || (back >= 0 && std::abs(back - d) <= options.consistency);
    out[x] = kUnknown;
    if (!consistent) continue;
    out[x] = static_cast<float>(d);
    if (d == 0 || d == D - 1) continue;
    const std::uint16_t* cost = sums + std::ptrdiff_t{x} * D + d;
    const int bend = cost[-1] - 2 * cost[0] + cost[1];
    if (bend > 0) out[x] += static_cast<float>(cost[-1] - cost[1]) / static_cast<float>(2 * bend);
  }
}

SemiGlobalMatcher::SemiGlobalMatcher(const SgmOptions& options, ThreadPool& pool,
                                     const Kernel* kernel) {
  CheckOptions(options);
  state_.reset(
      new State{options, pool, kernel != nullptr ? *kernel : *Kernels().front(), 0, 0, {}, {}});
}

SemiGlobalMatcher::~SemiGlobalMatcher() = default;
SemiGlobalMatcher::SemiGlobalMatcher(SemiGlobalMatcher&&) noexcept = default;

cv::Mat SemiGlobalMatcher::Disparity(const cv::Mat& left, const cv::Mat& right) {
  Require(left.type() == CV_8UC1 && right.type() == CV_8UC1 && left.size() == right.size() &&
              left.cols >= 5 && left.rows >= 5,
          "stereo pair", "images must be gray, 8 bit, equally large and 5 x 5 at least");
  State& state = *state_;
  state.width = left.cols;
  state.height = left.rows;
  const MatchPlanes left_planes(left, false, 0, state.pool);
  const MatchPlanes right_planes(right, true, state.options.disparities, state.pool);
  const std::size_t size = Size(state.RowSize(), state.height);
  state.costs.resize(size);
  for (Words& sums : state.sweeps) sums.resize(size);
  state.pool.For(state.height, kBand, [&](std::int64_t begin, std::int64_t end) {
    state.Costs(left_planes, right_planes, static_cast<int>(begin), static_cast<int>(end));
  });
  state.pool.For(2, 1, [&](std::int64_t begin, std::int64_t) { state.Sweep(begin == 0); });
  cv::Mat disparity(left.size(), CV_32F);
  state.pool.For(state.height, 8, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t y = begin; y < end; ++y) state.Winners(static_cast<int>(y), disparity);
  });
  if (state.options.speckle_size > 0) {
    cv::Mat fixed;
    disparity.convertTo(fixed, CV_16S, kPixel);
    cv::filterSpeckles(fixed, -kPixel, state.options.speckle_size,
                       state.options.speckle_step * kPixel);
    disparity.setTo(kUnknown, fixed < 0);
  }
  return disparity;
}

}  // namespace recollect::stereo
