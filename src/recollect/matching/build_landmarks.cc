#include "recollect/matching/build_landmarks.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "recollect/dataset/image.h"
#include "recollect/matching/match.h"

namespace recollect::matching {
namespace {

constexpr int kCellsX = 8, kCellsY = 6;  // over which landmarks are spread
constexpr double kRobust2 = 4;           // Cauchy's scale, squared standard deviations

// Frames whose cameras stand about the wanted distances away, on both sides; the frame first.
std::vector<std::size_t> Neighbours(const Lap& lap, std::size_t frame,
                                    const LandmarkOptions& options) {
  std::vector<std::size_t> found = {frame};
  const Eigen::Vector3d here = lap.WorldFromCamera(frame).translation();
  for (const int step : {-1, 1}) {
    std::size_t wanted = 0;
    for (std::size_t at = frame; wanted < std::size(options.baselines_m);) {
      if ((step < 0 && at == 0) || (step > 0 && at + 1 >= lap.frames.size())) break;
      at += static_cast<std::size_t>(step);
      const double distance = (lap.WorldFromCamera(at).translation() - here).norm();
      // Frames are rarely farther apart than a metre or two; a gap in the lap may be.
      if (distance > 2.5 * options.baselines_m[wanted]) break;
      if (distance < 0.95 * options.baselines_m[wanted]) continue;
      found.push_back(at);
      ++wanted;
    }
  }
  return found;
}

struct Term {
  Eigen::Vector3d a, t;  // the point in the other camera, times inverse depth: a + rho t
  Eigen::Vector2d pixel;
  double inverse_variance;
};

struct Cost {
  double value = 0, slope = 0, curvature = 0;
  int supports = 0;
};

Cost CostAt(double rho, const PinholeCamera& camera, const std::vector<Term>& terms,
            double prior_rho, double prior_inverse_variance) {
  Cost cost;
  const auto add = [&](double squared, double slope, double curvature) {
    const double weight = 1 / (1 + squared / kRobust2);
    cost.value += kRobust2 * std::log1p(squared / kRobust2);
    cost.slope += weight * slope;
    cost.curvature += weight * curvature;
  };
  for (const Term& term : terms) {
    const Eigen::Vector3d q = term.a + rho * term.t;
    if (q.z() < 1e-3) {
      cost.value += kRobust2 * std::log1p(1e4);
      continue;
    }
    const Eigen::Vector2d r = camera.Project(q) - term.pixel;
    const double z2 = q.z() * q.z();
    const Eigen::Vector2d j(camera.fx * (term.t.x() * q.z() - q.x() * term.t.z()) / z2,
                            camera.fy * (term.t.y() * q.z() - q.y() * term.t.z()) / z2);
    const double squared = term.inverse_variance * r.squaredNorm();
    if (squared < 9) ++cost.supports;
    add(squared, term.inverse_variance * j.dot(r), term.inverse_variance * j.squaredNorm());
  }
  if (prior_rho > 0) {
    const double off = rho - prior_rho;
    add(prior_inverse_variance * off * off, prior_inverse_variance * off, prior_inverse_variance);
  }
  return cost;
}

// Depth and standard deviation of its inverse from a depth image, 0 where unknown. Next to an edge
// the pixel may belong to either side.
std::pair<double, double> Look(const cv::Mat& depth, const PinholeCamera& camera,
                               const Eigen::Vector2d& pixel, double relative_error) {
  const double step = std::round(static_cast<double>(camera.width) / depth.cols);
  const int u = static_cast<int>(std::lround(pixel.x() / step));
  const int v = static_cast<int>(std::lround(pixel.y() / step));
  if (u < 0 || v < 0 || u >= depth.cols || v >= depth.rows) return {0, 0};
  const double z = static_cast<double>(depth.at<float>(v, u));
  if (z <= 0) return {0, 0};
  double sum2 = 0;
  int count = 0;
  for (int y = std::max(0, v - 1); y <= std::min(depth.rows - 1, v + 1); ++y) {
    for (int x = std::max(0, u - 1); x <= std::min(depth.cols - 1, u + 1); ++x) {
      const double near = static_cast<double>(depth.at<float>(y, x));
      const double off = (near > 0 ? 1 / near : 0) - 1 / z;
      sum2 += off * off;
      ++count;
    }
  }
  const double own = relative_error / z;
  return {z, std::sqrt(own * own + sum2 / count)};
}

}  // namespace

double PixelSigma(double size) { return std::max(0.4, 0.12 * size); }

Triangulated TriangulateDepth(const PinholeCamera& camera, const Eigen::Vector2d& pixel,
                              std::span<const Sighting> sightings, double prior_depth,
                              double prior_inverse_sigma, double nearest_m, double farthest_m) {
  const Eigen::Vector3d ray = camera.Unproject(pixel.x(), pixel.y(), 1);
  std::vector<Term> terms;
  for (const Sighting& s : sightings) {
    terms.push_back({s.other_from_keyframe.rotation() * ray, s.other_from_keyframe.translation(),
                     s.pixel, 1 / (s.pixel_sigma * s.pixel_sigma)});
  }
  const double prior_rho = prior_depth > 0 ? 1 / prior_depth : 0;
  const double information = prior_depth > 0 ? 1 / (prior_inverse_sigma * prior_inverse_sigma) : 0;
  const auto cost = [&](double rho) { return CostAt(rho, camera, terms, prior_rho, information); };
  if (terms.empty() && prior_depth <= 0) return {};
  double rho = prior_rho, least = prior_depth > 0 ? cost(rho).value : 1e300;
  constexpr int kStarts = 48;
  for (int i = 0; i < kStarts && !terms.empty(); ++i) {
    const double at = std::lerp(1 / farthest_m, 1 / nearest_m, std::pow(i / (kStarts - 1.0), 2));
    const double value = cost(at).value;
    if (value < least) {
      least = value;
      rho = at;
    }
  }
  Cost at = cost(rho);
  for (int i = 0; i < 10 && at.curvature > 0; ++i) {
    const double next = rho - at.slope / at.curvature;
    const Cost there = cost(next);
    if (!(there.value <= at.value)) break;
    const bool done = std::abs(next - rho) < 1e-9;
    rho = next;
    at = there;
    if (done) break;
  }
  if (!(at.curvature > 0) || rho < 1 / farthest_m || rho > 1 / nearest_m) return {};
  return {1 / rho, 1 / std::sqrt(at.curvature), at.supports};
}

Landmarks MakeLandmarks(const Lap& lap, std::size_t frame, const LandmarkOptions& options) {
  const PinholeCamera& camera = lap.camera.left;
  const std::vector<std::size_t> frames = Neighbours(lap, frame, options);
  const Features own = FindFeatures(ReadGray(lap.frames[frame].left), options.features);
  std::vector<std::vector<Sighting>> sightings(static_cast<std::size_t>(own.size()));
  for (const std::size_t other : std::span(frames).subspan(1)) {
    const Features its = FindFeatures(ReadGray(lap.frames[other].left), options.features);
    const SE3 other_from_keyframe =
        lap.WorldFromCamera(other).Inverse() * lap.WorldFromCamera(frame);
    for (const Match& m :
         MatchDescriptors(own.descriptors.data(), own.size(), its.descriptors.data(), its.size())) {
      const auto a = static_cast<std::size_t>(m.live), b = static_cast<std::size_t>(m.mapped);
      const double sigma = std::hypot(PixelSigma(own.sizes[a]), PixelSigma(its.sizes[b]));
      sightings[a].push_back({other_from_keyframe, its.pixels[b], sigma});
    }
  }
  cv::Mat depth;
  if (!lap.frames[frame].depth.empty()) {
    depth = ReadDepth(lap.frames[frame].depth, lap.depth_unit);
    DepthCamera(camera, depth.cols, depth.rows, lap.frames[frame].depth.string());
  }

  struct Candidate {
    int feature, supports;
    Landmark landmark;
  };
  std::vector<Candidate> candidates;
  for (int i = 0; i < own.size(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    const Eigen::Vector2d& pixel = own.pixels[at];
    const auto [prior, sigma] =
        depth.empty() ? std::pair(0.0, 0.0) : Look(depth, camera, pixel, options.depth_error);
    if (prior == 0 && static_cast<int>(sightings[at].size()) < options.min_sightings) continue;
    const Triangulated found = TriangulateDepth(camera, pixel, sightings[at], prior, sigma,
                                                options.nearest_m, options.farthest_m);
    if (found.depth == 0 || (prior == 0 && found.supports < options.min_sightings)) continue;
    // Seen elsewhere, but not where it ought to be: it moves by itself, or its depth is wrong.
    if (2 * found.supports < static_cast<int>(sightings[at].size())) continue;
    candidates.push_back(
        {i,
         found.supports,
         {camera.Unproject(pixel.x(), pixel.y(), found.depth), PixelSigma(own.sizes[at]),
          found.inverse_sigma * found.depth * found.depth}});
  }
  // The most often seen first, then the strongest; every part of the image has its share.
  std::stable_sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) {
    return std::min(a.supports, 2) > std::min(b.supports, 2);
  });
  const int share = 3 * options.count / (kCellsX * kCellsY);
  std::vector<int> in_cell(kCellsX * kCellsY, 0);
  std::vector<const Candidate*> chosen, left_over;
  for (const Candidate& c : candidates) {
    const Eigen::Vector2d& p = own.pixels[static_cast<std::size_t>(c.feature)];
    const int x = std::clamp(static_cast<int>(p.x() * kCellsX / camera.width), 0, kCellsX - 1);
    const int y = std::clamp(static_cast<int>(p.y() * kCellsY / camera.height), 0, kCellsY - 1);
    int& taken = in_cell[static_cast<std::size_t>(y * kCellsX + x)];
    (taken++ < share ? chosen : left_over).push_back(&c);
  }
  chosen.insert(chosen.end(), left_over.begin(), left_over.end());
  if (static_cast<int>(chosen.size()) > options.count) {
    chosen.resize(static_cast<std::size_t>(options.count));
  }

  Landmarks landmarks;
  for (const std::size_t source : frames) landmarks.sources.push_back(static_cast<int>(source));
  for (const Candidate* c : chosen) {
    landmarks.points.push_back(c->landmark);
    const std::int8_t* d = own.Descriptor(c->feature);
    landmarks.descriptors.insert(landmarks.descriptors.end(), d, d + kDescriptorBytes);
  }
  return landmarks;
}

}  // namespace recollect::matching
