#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "recollect/depth/superpixels.h"

namespace recollect::stereo {

// How two superpixels that touch lie to each other.
enum class BoundaryLabel : std::uint8_t {
  kCoplanar,      // one surface
  kHinge,         // two that meet at the boundary
  kFirstInFront,  // the first hides part of the second
  kSecondInFront
};

struct Boundary {
  int first = 0, second = 0;  // labels of superpixels, first < second
  BoundaryLabel label = BoundaryLabel::kCoplanar;
};

struct PlaneOptions {
  double smoothness = 400;   // pixels of data that agreement with a neighbour counts as
  double hinge_penalty = 5;  // px^2, as the two below
  double occlusion_penalty = 15;
  double impossible_penalty = 30;  // for an occlusion whose front is farther away
  double inlier_px = 3;            // disparities farther from the plane do not count
  double start_inlier_px = 1;      // the same while the first planes are drawn
  int draws = 64;                  // of three pixels, for each of the first planes
  std::uint64_t seed = 1;
};

// Planes of superpixels and labels of their boundaries, for a partition that may change between
// calls. labels: rows x cols of 32 bits; disparity: 32-bit float, negative where unknown.
class SlantedPlanes {
 public:
  explicit SlantedPlanes(const PlaneOptions& options) : options_(options) {}

  // First planes: RANSAC, then least squares over the inliers. Superpixels with next to no
  // disparities take the plane of the nearest that has one.
  void Begin(const cv::Mat& labels, const cv::Mat& disparity, int count);

  // Inliers of the present planes, then `rounds` times labels and planes in turn (section 3.3).
  void Refine(const cv::Mat& labels, const cv::Mat& disparity, int rounds);

  const std::vector<Plane>& planes() const { return planes_; }
  std::vector<Boundary> Boundaries() const;

 private:
  // Sums over pixels (x, y, 1): of products of these with each other and with disparities.
  struct Moments {
    Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
    Eigen::Vector3d disparities = Eigen::Vector3d::Zero();
  };
  struct Edge {
    Boundary boundary;
    std::vector<Eigen::Vector3d> pixels;  // on both sides, (x, y, 1)
    Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  };
  void Measure(const cv::Mat& labels, const cv::Mat& disparity);
  void FindEdges(const cv::Mat& labels);
  void LabelEdge(Edge& edge) const;
  void FitPlane(std::size_t i);
  Eigen::Vector3d Coefficients(int i) const;

  PlaneOptions options_;
  std::vector<Plane> planes_;
  std::vector<Moments> inliers_, all_;
  std::vector<Edge> edges_;
  std::vector<std::vector<std::size_t>> edges_of_;  // of each superpixel
};

}  // namespace recollect::stereo
