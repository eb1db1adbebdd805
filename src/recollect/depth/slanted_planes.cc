#include "recollect/depth/slanted_planes.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "recollect/core/random.h"

namespace recollect::stereo {
namespace {

constexpr std::size_t kEnough = 6;  // disparities that a plane is drawn from
// A superpixel without data and without smooth neighbours keeps its plane: a pull towards it that
// nothing else notices.
constexpr double kKeep = 1e-3;

struct Sample {
  double x, y, disparity;
};

Plane ToPlane(const Eigen::Vector3d& v) { return {v(0), v(1), v(2)}; }
Eigen::Vector3d ToVector(const Plane& p) { return {p.a, p.b, p.c}; }

int Inliers(const std::vector<Sample>& samples, const Plane& plane, double within) {
  int count = 0;
  for (const Sample& s : samples) {
    count += std::abs(plane.At(s.x, s.y) - s.disparity) < within ? 1 : 0;
  }
  return count;
}

// The plane through most samples.
Plane DrawPlane(const std::vector<Sample>& samples, const PlaneOptions& options, Random& random) {
  Plane best{0, 0, samples[samples.size() / 2].disparity};
  int most = Inliers(samples, best, options.start_inlier_px);
  const auto size = static_cast<std::int64_t>(samples.size());
  for (int draw = 0; draw < options.draws && most < static_cast<int>(size); ++draw) {
    Eigen::Matrix3d points;
    Eigen::Vector3d disparities;
    for (int k = 0; k < 3; ++k) {
      const Sample& s = samples[static_cast<std::size_t>(random.Index(size))];
      points.row(k) << s.x, s.y, 1;
      disparities(k) = s.disparity;
    }
    if (std::abs(points.determinant()) < 4) continue;  // nearly on a line: twice the area in px^2
    const Plane plane = ToPlane(points.inverse() * disparities);
    const int count = Inliers(samples, plane, options.start_inlier_px);
    if (count > most) {
      most = count;
      best = plane;
    }
  }
  return best;
}

// Least squares over the samples near the plane, pulled a little towards it.
Plane Polish(const std::vector<Sample>& samples, const Plane& plane, double within) {
  Eigen::Matrix3d products = Eigen::Matrix3d::Identity() * kKeep;
  Eigen::Vector3d right = ToVector(plane) * kKeep;
  for (const Sample& s : samples) {
    if (std::abs(plane.At(s.x, s.y) - s.disparity) >= within) continue;
    const Eigen::Vector3d m(s.x, s.y, 1);
    products += m * m.transpose();
    right += m * s.disparity;
  }
  return ToPlane(products.ldlt().solve(right));
}

}  // namespace

Eigen::Vector3d SlantedPlanes::Coefficients(int i) const {
  return ToVector(planes_[static_cast<std::size_t>(i)]);
}

void SlantedPlanes::Begin(const cv::Mat& labels, const cv::Mat& disparity, int count) {
  const auto size = static_cast<std::size_t>(count);
  std::vector<std::vector<Sample>> samples(size);
  std::vector<Eigen::Vector3d> middles(size, Eigen::Vector3d::Zero());
  for (int y = 0; y < labels.rows; ++y) {
    for (int x = 0; x < labels.cols; ++x) {
      const auto i = static_cast<std::size_t>(labels.at<std::int32_t>(y, x));
      const float d = disparity.at<float>(y, x);
      middles[i] += Eigen::Vector3d(x, y, 1);
      if (d >= 0) samples[i].push_back({double(x), double(y), d});
    }
  }
  planes_.assign(size, {});
  std::vector<std::size_t> known;
  for (std::size_t i = 0; i < size; ++i) {
    middles[i] /= std::max(1.0, middles[i].z());
    if (samples[i].size() < kEnough) continue;
    Random random(SubSeed(options_.seed, i));
    planes_[i] =
        Polish(samples[i], DrawPlane(samples[i], options_, random), options_.start_inlier_px);
    known.push_back(i);
  }
  if (known.empty()) return;
  for (std::size_t i = 0; i < size; ++i) {
    if (samples[i].size() >= kEnough) continue;
    const auto far = [&](std::size_t k) { return (middles[k] - middles[i]).squaredNorm(); };
    planes_[i] = planes_[*std::min_element(
        known.begin(), known.end(), [&](std::size_t a, std::size_t b) { return far(a) < far(b); })];
  }
}

void SlantedPlanes::Measure(const cv::Mat& labels, const cv::Mat& disparity) {
  inliers_.assign(planes_.size(), {});
  all_.assign(planes_.size(), {});
  for (int y = 0; y < labels.rows; ++y) {
    for (int x = 0; x < labels.cols; ++x) {
      const auto i = static_cast<std::size_t>(labels.at<std::int32_t>(y, x));
      const float d = disparity.at<float>(y, x);
      const Eigen::Vector3d m(x, y, 1);
      const Eigen::Matrix3d product = m * m.transpose();
      all_[i].products += product;
      if (d < 0 || std::abs(planes_[i].At(x, y) - d) >= options_.inlier_px) continue;
      inliers_[i].products += product;
      inliers_[i].disparities += m * d;
    }
  }
}

void SlantedPlanes::FindEdges(const cv::Mat& labels) {
  edges_.clear();
  edges_of_.assign(planes_.size(), {});
  const auto edge_between = [&](int a, int b) -> Edge& {
    const int first = std::min(a, b), second = std::max(a, b);
    auto& of_first = edges_of_[static_cast<std::size_t>(first)];
    for (const std::size_t e : of_first) {
      if (edges_[e].boundary.first == first && edges_[e].boundary.second == second) {
        return edges_[e];
      }
    }
    of_first.push_back(edges_.size());
    edges_of_[static_cast<std::size_t>(second)].push_back(edges_.size());
    return edges_.emplace_back(Edge{{first, second}, {}});
  };
  const auto join = [&](int x, int y, int u, int v) {
    const int a = labels.at<std::int32_t>(y, x), b = labels.at<std::int32_t>(v, u);
    if (a == b) return;
    Edge& edge = edge_between(a, b);
    for (const Eigen::Vector3d& m : {Eigen::Vector3d(x, y, 1), Eigen::Vector3d(u, v, 1)}) {
      edge.pixels.push_back(m);
      edge.products += m * m.transpose();
    }
  };
  for (int y = 0; y < labels.rows; ++y) {
    for (int x = 0; x < labels.cols; ++x) {
      if (x + 1 < labels.cols) join(x, y, x + 1, y);
      if (y + 1 < labels.rows) join(x, y, x, y + 1);
    }
  }
}

// The label with the least smoothness and prior energy (equations 7 to 9).
void SlantedPlanes::LabelEdge(Edge& edge) const {
  const Boundary& b = edge.boundary;
  const Eigen::Vector3d difference = Coefficients(b.first) - Coefficients(b.second);
  const double pixels = static_cast<double>(edge.pixels.size());
  const Moments &first = all_[static_cast<std::size_t>(b.first)],
                &second = all_[static_cast<std::size_t>(b.second)];
  const Eigen::Matrix3d both = first.products + second.products;
  const double coplanar = difference.dot(both * difference) / both(2, 2);
  const double hinge = difference.dot(edge.products * difference) / pixels;
  double first_behind = 0, second_behind = 0;
  for (const Eigen::Vector3d& m : edge.pixels) {
    const double ahead = difference.dot(m);
    first_behind += ahead < 0 ? 1 : 0;
    second_behind += ahead > 0 ? 1 : 0;
  }
  const double impossible = options_.impossible_penalty / pixels;
  const std::array<double, 4> energies = {coplanar, hinge + options_.hinge_penalty,
                                          options_.occlusion_penalty + impossible * first_behind,
                                          options_.occlusion_penalty + impossible * second_behind};
  const auto least = std::min_element(energies.begin(), energies.end());
  edge.boundary.label = static_cast<BoundaryLabel>(least - energies.begin());
}

// Least squares of one plane, its neighbours' held still.
void SlantedPlanes::FitPlane(std::size_t i) {
  Eigen::Matrix3d products = inliers_[i].products + kKeep * Eigen::Matrix3d::Identity();
  Eigen::Vector3d right = inliers_[i].disparities + kKeep * ToVector(planes_[i]);
  for (const std::size_t e : edges_of_[i]) {
    const Edge& edge = edges_[e];
    const Boundary& b = edge.boundary;
    const int other = b.first == static_cast<int>(i) ? b.second : b.first;
    Eigen::Matrix3d shared;
    if (b.label == BoundaryLabel::kHinge) {
      shared = edge.products / static_cast<double>(edge.pixels.size());
    } else if (b.label == BoundaryLabel::kCoplanar) {
      shared = all_[i].products + all_[static_cast<std::size_t>(other)].products;
      shared /= shared(2, 2);
    } else {
      continue;
    }
    products += options_.smoothness * shared;
    right += options_.smoothness * (shared * Coefficients(other));
  }
  planes_[i] = ToPlane(products.ldlt().solve(right));
}

void SlantedPlanes::Refine(const cv::Mat& labels, const cv::Mat& disparity, int rounds) {
  Measure(labels, disparity);
  FindEdges(labels);
  for (int round = 0; round < rounds; ++round) {
    for (Edge& edge : edges_) LabelEdge(edge);
    for (std::size_t i = 0; i < planes_.size(); ++i) FitPlane(i);
  }
}

std::vector<Boundary> SlantedPlanes::Boundaries() const {
  std::vector<Boundary> boundaries;
  for (const Edge& edge : edges_) boundaries.push_back(edge.boundary);
  return boundaries;
}

}  // namespace recollect::stereo
