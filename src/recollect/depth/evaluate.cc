#include "recollect/depth/evaluate.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "recollect/core/error.h"
#include "recollect/core/stopwatch.h"
#include "recollect/dataset/image.h"
#include "recollect/depth/disparity.h"

namespace recollect::stereo {
namespace {

double Median(std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double Share(std::int64_t part, std::int64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

struct Truth {
  cv::Mat disparity;  // 0 where unknown
  cv::Mat seen;       // by the right camera
  int step = 1;       // pixels of the image to one of these
};

Truth ReadTruth(const Lap& lap, const Frame& frame) {
  const cv::Mat depth = ReadDepth(frame.depth, lap.depth_unit);
  DepthCamera(lap.camera.left, depth.cols, depth.rows, frame.depth.string());
  Truth truth{cv::Mat::zeros(depth.size(), CV_32F), {}, lap.camera.left.width / depth.cols};
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      const float z = depth.at<float>(v, u);
      if (z > 0) truth.disparity.at<float>(v, u) = static_cast<float>(lap.camera.Depth(z));
    }
  }
  truth.seen = SeenByRight(truth.disparity, truth.step, lap.camera.left.width);
  return truth;
}

// Adds up the errors of one method.
class Tally {
 public:
  void Add(const Truth& truth, const cv::Mat& disparity, double ms) {
    const cv::Mat filled = FillFromBackground(disparity);
    for (int v = 0; v < truth.disparity.rows; ++v) {
      for (int u = 0; u < truth.disparity.cols; ++u) {
        const double expected = truth.disparity.at<float>(v, u);
        if (expected <= 0) continue;
        const int y = v * truth.step, x = u * truth.step;
        const double dense = filled.at<float>(y, x);
        const bool known = disparity.at<float>(y, x) >= 0;
        const bool bad = !(std::abs(dense - expected) <= 3);
        counts_[0].Add(known, bad);
        if (truth.seen.at<uchar>(v, u) != 0) counts_[1].Add(known, bad);
        bad1_ += !(std::abs(dense - expected) <= 1) ? 1 : 0;
        // |Z - Z'| / Z with Z = fB / d and Z' = fB / d'.
        relative_.push_back(std::abs(expected / std::max(dense, 1e-3) - 1));
      }
    }
    ms_.push_back(ms);
  }

  DisparityErrors Errors() {
    const Counts &all = counts_[0], &seen = counts_[1];
    DisparityErrors e;
    e.density = Share(all.known, all.all);
    e.bad3 = Share(all.bad, all.all);
    e.bad1 = Share(bad1_, all.all);
    e.rel_median = Median(relative_);
    e.bad3_valid = Share(all.known_bad, all.known);
    e.bad3_visible = Share(seen.bad, seen.all);
    e.bad3_visible_valid = Share(seen.known_bad, seen.known);
    e.ms = Median(ms_);
    return e;
  }
  std::int64_t pixels() const { return counts_[0].all; }
  double visible() const { return Share(counts_[1].all, counts_[0].all); }

 private:
  struct Counts {
    std::int64_t all = 0, known = 0, bad = 0, known_bad = 0;
    void Add(bool is_known, bool is_bad) {
      ++all;
      known += is_known ? 1 : 0;
      bad += is_bad ? 1 : 0;
      known_bad += is_known && is_bad ? 1 : 0;
    }
  };
  std::array<Counts, 2> counts_;  // all pixels; those seen by the right camera
  std::int64_t bad1_ = 0;
  std::vector<double> relative_, ms_;
};

}  // namespace

cv::Mat SeenByRight(const cv::Mat& true_disparity, int step, int width) {
  cv::Mat seen = cv::Mat::zeros(true_disparity.size(), CV_8U);
  std::vector<float> nearest(static_cast<std::size_t>(width));
  for (int v = 0; v < seen.rows; ++v) {
    const float* row = true_disparity.ptr<float>(v);
    const auto column = [&](int u) { return static_cast<float>(u * step) - row[u]; };
    std::fill(nearest.begin(), nearest.end(), 0.F);
    // The nearest that lies in each column of the right image: between neighbours on one surface
    // all columns are covered.
    for (int u = 0; u < seen.cols; ++u) {
      if (row[u] <= 0) continue;
      const bool joined = u + 1 < seen.cols && row[u + 1] > 0 && std::abs(row[u + 1] - row[u]) <= 1;
      const float from = column(u), to = joined ? column(u + 1) : from;
      const int last = std::min(width - 1, static_cast<int>(std::lround(std::max(from, to))));
      for (int c = std::max(0, static_cast<int>(std::lround(std::min(from, to)))); c <= last; ++c) {
        float& d = nearest[static_cast<std::size_t>(c)];
        d = std::max(d, row[u]);
      }
    }
    for (int u = 0; u < seen.cols; ++u) {
      const long c = std::lround(column(u));
      if (row[u] <= 0 || c < 0 || c >= width) continue;
      const bool hidden = nearest[static_cast<std::size_t>(c)] > row[u] + 1;
      seen.at<uchar>(v, u) = hidden ? 0 : 255;
    }
  }
  return seen;
}

DepthEvaluation EvaluateDepth(const Lap& lap, const MatchOptions& options, int every,
                              ThreadPool& pool, const ProgressSink& progress) {
  Require(every >= 1, "every", "must be at least 1");
  std::vector<std::size_t> frames;
  std::size_t eligible = 0;
  for (std::size_t i = 0; i < lap.frames.size(); ++i) {
    if (lap.frames[i].right.empty() || lap.frames[i].depth.empty()) continue;
    if (eligible++ % static_cast<std::size_t>(every) == 0) frames.push_back(i);
  }
  Require(!frames.empty(), lap.folder.string(), "no frame has a right image and true depth",
          "they belong in image_3 (or image_1) and depth");
  constexpr std::array kMethods = {Method::kSps, Method::kSgm, Method::kSgbm};
  std::array<Tally, kMethods.size()> tallies;
  std::vector<Matcher> matchers;
  for (const Method method : kMethods) {
    MatchOptions one = options;
    one.method = method;
    matchers.emplace_back(one, pool);
  }
  DepthEvaluation result;
  for (const std::size_t i : frames) {
    const Frame& frame = lap.frames[i];
    const cv::Mat left = ReadColour(frame.left), right = ReadColour(frame.right);
    const Truth truth = ReadTruth(lap, frame);
    for (std::size_t m = 0; m < matchers.size(); ++m) {
      const Stopwatch watch;
      const cv::Mat disparity = matchers[m].Disparity(left, right);
      tallies[m].Add(truth, disparity, watch.Milliseconds());
    }
    Report(progress, "depth-eval", ++result.frames, std::ssize(frames));
  }
  result.pixels = tallies[0].pixels();
  result.visible = tallies[0].visible();
  for (std::size_t m = 0; m < matchers.size(); ++m) {
    result.methods.push_back({kMethods[m], tallies[m].Errors()});
  }
  return result;
}

}  // namespace recollect::stereo
