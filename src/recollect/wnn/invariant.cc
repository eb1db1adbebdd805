#include "recollect/wnn/invariant.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/wnn/bit_square.h"
#include "recollect/wnn/kernel.h"
#include "recollect/wnn/shrink.h"

namespace recollect::wnn {
namespace {

constexpr double kReferenceWidth = 640;
constexpr double kFloor = 4;     // gray levels of contrast that count as none
constexpr double kSteps = 4096;  // whole numbers that a normalised unit is cut into

double WorkingScale(const NetworkOptions& options, int width) {
  if (options.working_width == 0 || width <= options.working_width) return 1;
  return static_cast<double>(options.working_width) / width;
}

int Scaled(int length, double scale) {
  return std::max(8, static_cast<int>(std::lround(length * scale)));
}

// Luma alone, or the opponent channels.
std::vector<cv::Mat> ChannelsOf(const cv::Mat& image, Code code) {
  cv::Mat gray = image;
  if (image.channels() == 3) cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  gray.convertTo(gray, CV_32F);
  if (code != Code::kOpponent) return {gray};
  if (image.channels() == 1) return {gray, gray, gray};
  cv::Mat real;
  image.convertTo(real, CV_32F);
  std::array<cv::Mat, 3> bgr;
  cv::split(real, bgr.data());
  return {gray, bgr[2] - bgr[0], bgr[1] - 0.5 * (bgr[0] + bgr[2])};
}

// Local contrast: how far a value lies from the mean of its surrounding, in units of their spread.
cv::Mat Normalised(const cv::Mat& values, double sigma) {
  cv::Mat mean, variance, spread;
  cv::GaussianBlur(values, mean, {}, sigma, 0, cv::BORDER_REFLECT_101);
  const cv::Mat difference = values - mean;
  cv::GaussianBlur(difference.mul(difference), variance, {}, sigma, 0, cv::BORDER_REFLECT_101);
  cv::sqrt(variance, spread);
  return difference / (spread + kFloor);
}

// The bits of one neuron, from where its synapses look. Two words each.
void Compare(const std::int32_t* values, const std::int32_t* at, std::uint64_t* words) {
  words[0] = words[1] = 0;
  for (int i = 0; i < kSynapses; ++i) {
    const bool below = values[at[i]] < values[at[(i + 1) % kSynapses]];
    words[i / 64] |= std::uint64_t{below} << (i % 64);
  }
}

void Gather(const std::uint8_t* bits, const std::int32_t* at, std::uint64_t* words) {
  for (int w = 0; w < kWords; ++w) {
    std::uint64_t word = 0;
    for (int i = 0; i < 64; ++i) word |= std::uint64_t{bits[at[64 * w + i]]} << i;
    words[w] = word;
  }
}

void Rank(const std::int32_t* values, const std::int32_t* at, std::uint64_t* words) {
  std::array<std::int32_t, kSynapses> sorted;
  for (std::size_t i = 0; i < kSynapses; ++i) sorted[i] = values[at[i]];
  std::nth_element(sorted.begin(), sorted.begin() + kSynapses / 2, sorted.end());
  words[0] = words[1] = 0;
  for (int i = 0; i < kSynapses; ++i) {
    words[i / 64] |= std::uint64_t{values[at[i]] > sorted[kSynapses / 2]} << (i % 64);
  }
}

}  // namespace

bool InvariantEncoder::Wanted(const NetworkOptions& options) {
  return options.code == Code::kOpponent || options.cells != Cells::kCompare ||
         options.working_width > 0 || options.contrast_sigma > 0 || options.blur_scales > 1;
}

InvariantEncoder::InvariantEncoder(const NetworkOptions& options, int image_width, int image_height,
                                   ThreadPool& pool)
    : options_(options), pool_(pool), scale_(WorkingScale(options, image_width)) {
  const Synapses synapses(options, Scaled(image_width, scale_), Scaled(image_height, scale_));
  width_ = synapses.window_width();
  height_ = synapses.window_height();
  unit_ = width_ / kReferenceWidth;
  arm_ = std::max(1, static_cast<int>(std::lround(options.gradient_arm * unit_)));
  const int channels = options.code == Code::kOpponent ? 3 : 1;
  const int uniform = kSynapses - options.gaussian_synapses;
  const bool gradient = options.cells == Cells::kGradient;
  for (int n = 0; n < synapses.neurons(); ++n) {
    for (int i = 0; i < kSynapses; ++i) {
      const bool sharp = !options.blur || i < uniform;
      const int blur =
          sharp ? 0
                : 1 + (i - uniform) * options.blur_scales / std::max(1, options.gaussian_synapses);
      const int plane = blur * channels + i * channels / kSynapses;
      synapses_.push_back(synapses.Of(n)[i]);
      plane_of_.push_back(gradient ? 2 * plane + i % 2 : plane);
    }
  }
  SetMargin({});
}

Pixel InvariantEncoder::Working(Pixel shift) const {
  return {static_cast<int>(std::lround(shift.x * scale_)),
          static_cast<int>(std::lround(shift.y * scale_))};
}

void InvariantEncoder::SetMargin(Pixel margin) {
  if (margin.x == margin_.x && margin.y == margin_.y) return;
  margin_ = margin;
  const int stride = width_ + 2 * margin.x, area = stride * (height_ + 2 * margin.y);
  offsets_.clear();
  for (std::size_t i = 0; i < synapses_.size(); ++i) {
    offsets_.push_back(plane_of_[i] * area + (synapses_[i].y + margin.y) * stride + synapses_[i].x +
                       margin.x);
  }
}

// Signs of differences over the arm, for every pixel within the margin.
void InvariantEncoder::AddGradients(const cv::Mat& padded) {
  const int stride = width_ + 2 * margin_.x, rows = height_ + 2 * margin_.y;
  for (const cv::Point arm : {cv::Point(arm_, 0), cv::Point(0, arm_)}) {
    for (int y = 0; y < rows; ++y) {
      const auto* before = padded.ptr<float>(y + arm_ - arm.y) + arm_ - arm.x;
      const auto* after = padded.ptr<float>(y + arm_ + arm.y) + arm_ + arm.x;
      const std::size_t at = rising_.size();
      rising_.resize(at + static_cast<std::size_t>(stride));
      for (int x = 0; x < stride; ++x) {
        rising_[at + static_cast<std::size_t>(x)] = before[x] < after[x];
      }
    }
  }
}

void InvariantEncoder::AddPlane(const cv::Mat& channel, double blur) {
  cv::Mat seen = channel, padded;
  if (blur > 0) cv::GaussianBlur(channel, seen, {}, blur * unit_, 0, cv::BORDER_REFLECT_101);
  if (options_.contrast_sigma > 0) seen = Normalised(seen, options_.contrast_sigma * unit_);
  const bool gradient = options_.cells == Cells::kGradient;
  const int more = gradient ? arm_ : 0;
  cv::copyMakeBorder(seen, padded, margin_.y + more, margin_.y + more, margin_.x + more,
                     margin_.x + more, cv::BORDER_REPLICATE);
  if (gradient) return AddGradients(padded);
  for (int y = 0; y < padded.rows; ++y) {
    const auto* row = padded.ptr<float>(y);
    for (int x = 0; x < padded.cols; ++x) {
      values_.push_back(
          static_cast<std::int32_t>(std::lround(static_cast<double>(row[x]) * kSteps)));
    }
  }
}

void InvariantEncoder::Look(const cv::Mat& image, Pixel reach) {
  SetMargin(Working({std::abs(reach.x), std::abs(reach.y)}));
  const cv::Size size(Scaled(image.cols, scale_), Scaled(image.rows, scale_));
  const cv::Mat working =
      scale_ < 1 ? Shrunk(image, size, height_) : cv::Mat(image.rowRange(0, height_));
  values_.clear();
  rising_.clear();
  const std::vector<cv::Mat> channels = ChannelsOf(working, options_.code);
  for (const cv::Mat& channel : channels) AddPlane(channel, 0);
  double blur = options_.blur_sigma;
  for (int scale = 0; options_.blur && scale < options_.blur_scales; ++scale, blur *= 2) {
    for (const cv::Mat& channel : channels) AddPlane(channel, blur);
  }
  PackBits(rising_, packed_);
}

std::ptrdiff_t InvariantEncoder::Moved(Pixel shift) const {
  const Pixel by = Working(shift);
  Require(std::abs(by.x) <= margin_.x && std::abs(by.y) <= margin_.y, "displacement",
          "is beyond what the image was prepared for");
  return std::ptrdiff_t{by.y} * (width_ + 2 * margin_.x) + by.x;
}

BitRuns InvariantEncoder::RunsUnder(std::span<const Pixel> shifts) const {
  std::vector<std::ptrdiff_t> moved;
  for (const Pixel shift : shifts) moved.push_back(Moved(shift));
  return RunsOf(std::move(moved));
}

// Bits of neighbouring pixels lie side by side, so one read of a word tells what a synapse sees
// under many shifts; turning a square of bits around makes them patterns.
void InvariantEncoder::Read(const BitRuns& runs, std::size_t neuron,
                            std::span<std::uint64_t> words) const {
  const std::size_t shifts = runs.moved.size();
  const auto turn = Kernels().front()->turn;
  for (std::size_t w = 0; w < kWords; ++w) {
    const std::int32_t* at = offsets_.data() + neuron * kSynapses + 64 * w;
    std::uint64_t* row = words.data() + w * shifts;
    for (const BitRuns::Run& run : runs.runs) {
      if (run.reach == run.end - run.begin) {
        turn(packed_.data(), at, run.moved, run.reach, row + run.begin);
        continue;
      }
      std::uint64_t columns[kReach];
      turn(packed_.data(), at, run.moved, run.reach, columns);
      for (auto i = static_cast<std::size_t>(run.begin); i < static_cast<std::size_t>(run.end);
           ++i) {
        row[i] = columns[runs.moved[i] - run.moved];
      }
    }
  }
}

std::vector<std::uint64_t> InvariantEncoder::ReadAll(const BitRuns& runs) const {
  const std::size_t count = kWords * runs.moved.size(), neurons = offsets_.size() / kSynapses;
  std::vector<std::uint64_t> words(neurons * count);
  pool_.For(static_cast<std::int64_t>(neurons), 16, [&](std::int64_t begin, std::int64_t end) {
    for (auto n = static_cast<std::size_t>(begin); n < static_cast<std::size_t>(end); ++n) {
      Read(runs, n, std::span(words).subspan(n * count, count));
    }
  });
  return words;
}

void InvariantEncoder::Encode(Pixel shift, std::span<std::uint64_t> pattern) const {
  const std::ptrdiff_t moved = Moved(shift);
  pool_.For(static_cast<std::int64_t>(offsets_.size()) / kSynapses, 128,
            [&](std::int64_t begin, std::int64_t end) {
              for (std::int64_t n = begin; n < end; ++n) {
                const std::int32_t* at = offsets_.data() + n * kSynapses;
                std::uint64_t* words = pattern.data() + n * kWords;
                switch (options_.cells) {
                  case Cells::kCompare:
                    Compare(values_.data() + moved, at, words);
                    break;
                  case Cells::kGradient:
                    Gather(rising_.data() + moved, at, words);
                    break;
                  case Cells::kRank:
                    Rank(values_.data() + moved, at, words);
                    break;
                }
              }
            });
}

}  // namespace recollect::wnn
