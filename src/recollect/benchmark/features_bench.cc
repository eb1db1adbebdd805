#include "recollect/benchmark/features_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "recollect/core/error.h"
#include "recollect/core/stopwatch.h"
#include "recollect/dataset/image.h"
#include "recollect/evaluation/statistics.h"
#include "recollect/matching/describe.h"
#include "recollect/matching/features.h"
#include "recollect/matching/kernel.h"
#include "recollect/matching/match.h"
#include "recollect/matching/variants.h"

namespace recollect {
namespace {

using matching::kDescriptorBytes;

constexpr double kContrast = 0.003;  // as FeatureOptions has it
constexpr double kSigma = 1.6;       // of the blur measured

// Fused multiplications and additions in registers: results that nobody can leave out.
RECOLLECT_VARIANTS
float MultiplyAndAdd(int rounds, float factor) {
  constexpr int kLanes = 16, kChains = 12;
  float sums[kChains][kLanes];
  for (auto& chain : sums) std::fill_n(chain, kLanes, 1.0f);
  for (int i = 0; i < rounds; ++i) {
    for (auto& chain : sums) {
      for (float& sum : chain) sum = sum * factor + factor;
    }
  }
  float total = 0;
  for (const auto& chain : sums) {
    for (const float sum : chain) total += sum;
  }
  return total;
}

// Multiplications of floats a second.
double FloatPeak() {
  constexpr int kRounds = 2'000'000;
  volatile float sink = MultiplyAndAdd(1000, 0.5f);
  const Stopwatch watch;
  sink = MultiplyAndAdd(kRounds, 0.5f);
  (void)sink;
  return 16.0 * 12 * kRounds / watch.Seconds();
}

// Products of bytes a second of the kernel where all it reads lies in the nearest cache.
double BytePeak() {
  const matching::Kernel& kernel = *matching::Kernels().front();
  const auto rows = static_cast<std::size_t>(kernel.rows);
  constexpr int kCount = 64, kRounds = 20'000;
  const std::vector<std::int8_t> some(kCount * kDescriptorBytes, 3),
      own(rows * kDescriptorBytes, 5);
  const matching::PackedDescriptors packed(some.data(), kCount);
  std::vector<int> out(rows * kCount);
  const Stopwatch watch;
  for (int i = 0; i < kRounds; ++i) {
    kernel.products(own.data(), kernel.rows, packed.data(), packed.groups(), out.data());
  }
  return static_cast<double>(rows) * kCount * kDescriptorBytes * kRounds / watch.Seconds();
}

class Times {
 public:
  template <typename Body>
  void Take(const std::string& step, const std::string& whose, const Body& body) {
    const Stopwatch watch;
    body();
    times_[step][whose].push_back(watch.Milliseconds());
  }
  double Median(const std::string& step, const std::string& whose) const {
    return Quantile(times_.at(step).at(whose), 0.5);
  }
  nlohmann::json Figures() const {
    nlohmann::json figures;
    for (const auto& [step, whose] : times_) {
      const double ours = Median(step, "ours"), theirs = Median(step, "opencv");
      figures["ms"][step] = {{"ours", ours}, {"opencv", theirs}};
      figures["ratio"][step] = ours / theirs;
    }
    return figures;
  }

 private:
  std::map<std::string, std::map<std::string, std::vector<double>>> times_;
};

}  // namespace

nlohmann::json RunFeaturesBench(const Lap& lap, const FeaturesBenchOptions& options) {
  Require(!lap.frames.empty() && !lap.frames.front().left.empty(), lap.folder.string(),
          "has no images");
  cv::setNumThreads(1);
  Times times;
  cv::Mat last_theirs;
  matching::Features last_ours;
  double multiplications = 0, products = 0;
  for (int i = 0; i < options.images; ++i) {
    const auto count = static_cast<std::int64_t>(lap.frames.size());
    const auto at = static_cast<std::size_t>(i * count / options.images);
    cv::Mat gray = matching::ToGray(ReadColour(lap.frames[at].left)), small, floats, blurred;
    cv::resize(gray, small, {}, 0.5, 0.5, cv::INTER_AREA);
    gray.convertTo(floats, CV_32F);
    const int side = 2 * static_cast<int>(std::ceil(3 * kSigma)) + 1;
    times.Take("blur", "ours", [&] { matching::Blur(floats, blurred, kSigma); });
    times.Take("blur", "opencv", [&] {
      cv::GaussianBlur(floats, blurred, {side, side}, kSigma, kSigma);
    });
    multiplications = 2.0 * (side / 2 + 1) * static_cast<double>(floats.total());

    std::vector<cv::KeyPoint> theirs;
    const auto sift = cv::SIFT::create(800, matching::kLayers, kContrast, 10, matching::kBaseSigma);
    times.Take("points", "opencv", [&] { sift->detect(small, theirs); });
    cv::Mat descriptors;
    times.Take("descriptors", "opencv", [&] { sift->compute(small, theirs, descriptors); });
    matching::Features ours;
    std::vector<matching::ScalePoint> points;
    times.Take("points", "ours",
               [&] { points = matching::FindPoints(matching::ScaleSpace(small), kContrast); });
    points.resize(std::min<std::size_t>(points.size(), 800));
    times.Take("descriptors", "ours",
               [&] { ours.descriptors = matching::Describe(matching::ScaleSpace(small), points); });

    if (i > 0 && !last_theirs.empty() && !descriptors.empty()) {
      const int before = static_cast<int>(last_ours.descriptors.size()) / kDescriptorBytes;
      const int now = static_cast<int>(ours.descriptors.size()) / kDescriptorBytes;
      times.Take("match", "ours", [&] {
        matching::MatchDescriptors(ours.descriptors.data(), now, last_ours.descriptors.data(),
                                   before);
      });
      products = static_cast<double>(now) * before * kDescriptorBytes;
      std::vector<cv::DMatch> matches;
      times.Take("match", "opencv", [&] {
        cv::BFMatcher(cv::NORM_L2, true).match(descriptors, last_theirs, matches);
      });
    }
    last_theirs = descriptors;
    last_ours = ours;
  }
  nlohmann::json figures = times.Figures();
  const auto share = [&](const char* step, double work, double peak) {
    figures["share_of_peak"][step] = work / (1e-3 * times.Median(step, "ours")) / peak;
  };
  share("blur", multiplications, FloatPeak());
  if (products > 0) share("match", products, BytePeak());
  figures["images"] = options.images;
  figures["kernel"] = matching::Kernels().front()->name;
  return figures;
}

std::string DescribeFeaturesBench(const nlohmann::json& figures) {
  std::string text = fmt::format("{} images, one thread, ms        ours  opencv   ratio\n",
                                 figures["images"].get<int>());
  for (const char* step : {"blur", "points", "descriptors", "match"}) {
    if (!figures["ms"].contains(step)) continue;
    const auto& ms = figures["ms"][step];
    text += fmt::format("  {:<28}{:>8.2f}{:>8.2f}{:>8.2f}\n", step, ms["ours"].get<double>(),
                        ms["opencv"].get<double>(), figures["ratio"][step].get<double>());
  }
  for (const auto& [step, share] : figures["share_of_peak"].items()) {
    text += fmt::format("  {}: {:.0f} % of the multiplications that registers alone allow\n", step,
                        100 * share.get<double>());
  }
  return text;
}

}  // namespace recollect
