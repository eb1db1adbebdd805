#include "recollect/matching/refine.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace recollect::matching {
namespace {

constexpr double kExpectedFeatures = 20;
constexpr double kNearest = 0.1;  // metres before the camera; nearer points say nothing

// d projection / d p_camera.
Eigen::Matrix<double, 2, 3> ProjectionJacobian(const PinholeCamera& camera,
                                               const Eigen::Vector3d& p) {
  const double iz = 1 / p.z();
  Eigen::Matrix<double, 2, 3> j;
  j << camera.fx * iz, 0, -camera.fx * p.x() * iz * iz, 0, camera.fy * iz,
      -camera.fy * p.y() * iz * iz;
  return j;
}

// Inverse covariance of the residual: the pixel's and the point's, seen from the live camera.
Eigen::Matrix2d Information(const Observation& o, const Eigen::Matrix<double, 2, 3>& projection,
                            const Eigen::Matrix3d& camera_from_world) {
  const Eigen::Matrix<double, 2, 3> j = projection * camera_from_world;
  const Eigen::Matrix2d covariance = j * o.covariance_world * j.transpose() +
                                     o.pixel_sigma * o.pixel_sigma * Eigen::Matrix2d::Identity();
  return covariance.inverse();
}

// (T Exp(xi))^-1 p_world = Exp(-xi) p = p - rotation x p - translation to first order.
Eigen::Matrix<double, 2, 6> PoseJacobian(const Eigen::Matrix<double, 2, 3>& projection,
                                         const Eigen::Vector3d& p) {
  Eigen::Matrix<double, 2, 6> jacobian;
  jacobian << projection * Hat(p), -projection;
  return jacobian;
}

struct NormalEquations {
  Matrix6d hessian = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  std::vector<Vector6d> gradients;  // each observation's part
};

NormalEquations Linearise(std::span<const Observation> observations, const PinholeCamera& camera,
                          const SE3& pose, const RefineOptions& options,
                          std::vector<double>& deviations) {
  NormalEquations sum;
  const SE3 camera_from_world = pose.Inverse();
  deviations.clear();
  sum.gradients.reserve(observations.size());
  for (const Observation& o : observations) {
    const Eigen::Vector3d p = camera_from_world * o.p_world;
    if (p.z() < kNearest) {
      deviations.push_back(std::numeric_limits<double>::infinity());
      sum.gradients.push_back(Vector6d::Zero());
      continue;
    }
    const Eigen::Matrix<double, 2, 3> projection = ProjectionJacobian(camera, p);
    const Eigen::Matrix<double, 2, 6> jacobian = PoseJacobian(projection, p);
    const Eigen::Vector2d r = camera.Project(p) - o.pixel;
    const Eigen::Matrix2d information = Information(o, projection, camera_from_world.rotation());
    const double squared = r.dot(information * r);
    deviations.push_back(std::sqrt(squared));
    const double weight = 1 / (1 + squared / (options.robust_scale * options.robust_scale));
    const Eigen::Matrix<double, 6, 2> weighed = weight * jacobian.transpose() * information;
    sum.hessian += weighed * jacobian;
    sum.gradients.push_back(weighed * r);
    sum.gradient += sum.gradients.back();
  }
  return sum;
}

void AddPrior(const PosePrior& prior, const SE3& pose, NormalEquations& sum) {
  // Near the mean Log(mean^-1 pose Exp(xi)) = Log(mean^-1 pose) + xi to first order.
  const Vector6d off = (prior.world_from_camera.Inverse() * pose).Log();
  const Matrix6d information = prior.covariance.inverse();
  sum.hessian += information;
  sum.gradient += information * off;
}

// The covariance of the sum of the gradients, as they scatter from cluster to cluster (see
// Observation; -1 is a cluster by itself), and how many clusters there are.
std::pair<Matrix6d, double> Scatter(std::span<const Observation> observations,
                                    const std::vector<Vector6d>& gradients,
                                    int Observation::*cluster) {
  std::vector<std::size_t> order(observations.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto of = [&](std::size_t i) { return observations[i].*cluster; };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return of(a) < of(b); });
  Matrix6d scatter = Matrix6d::Zero();
  double clusters = 0;
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    Vector6d together = gradients[order[begin]];
    for (end = begin + 1;
         end < order.size() && of(order[begin]) >= 0 && of(order[end]) == of(order[begin]); ++end) {
      together += gradients[order[end]];
    }
    if (together.isZero(0)) continue;  // behind the camera
    scatter += together * together.transpose();
    ++clusters;
  }
  // Six of the degrees of freedom were spent on the pose.
  return {scatter * (clusters / std::max(1.0, clusters - 6)), clusters};
}

// Few features tell little of six dimensions: it is as if some more had scattered as the Hessian
// says.
Matrix6d Scatter(std::span<const Observation> observations, const NormalEquations& sum) {
  const auto [by_feature, features] = Scatter(observations, sum.gradients, &Observation::feature);
  Matrix6d scatter =
      (features * by_feature + kExpectedFeatures * sum.hessian) / (features + kExpectedFeatures);
  const bool mapped = !observations.empty() && observations.front().key_frame >= 0;
  if (mapped) scatter += Scatter(observations, sum.gradients, &Observation::key_frame).first;
  return scatter;
}

}  // namespace

Eigen::Vector2d Residual(const Observation& o, const PinholeCamera& camera,
                         const SE3& world_from_camera, Eigen::Matrix<double, 2, 6>* jacobian) {
  const Eigen::Vector3d p = world_from_camera.Inverse() * o.p_world;
  if (jacobian != nullptr) *jacobian = PoseJacobian(ProjectionJacobian(camera, p), p);
  return camera.Project(p) - o.pixel;
}

std::optional<RefinedPose> RefinePose(std::span<const Observation> observations,
                                      const PinholeCamera& camera, const SE3& start,
                                      const RefineOptions& options,
                                      const std::optional<PosePrior>& prior) {
  RefinedPose result{start, {}, {}, false};
  for (int iteration = 0; iteration <= options.max_iterations; ++iteration) {
    NormalEquations sum =
        Linearise(observations, camera, result.world_from_camera, options, result.deviations);
    const bool last = result.converged || iteration == options.max_iterations;
    Matrix6d scatter;
    if (last) scatter = Scatter(observations, sum);
    if (prior) AddPrior(*prior, result.world_from_camera, sum);
    const Eigen::LDLT<Matrix6d> ldlt(sum.hessian);
    if (ldlt.info() != Eigen::Success || !(ldlt.rcond() > 1e-12)) return std::nullopt;
    if (last) {
      if (prior) scatter += prior->covariance.inverse();
      const Matrix6d inverse = ldlt.solve(Matrix6d::Identity());
      result.covariance = inverse * scatter * inverse;
      break;
    }
    const Vector6d step = -ldlt.solve(sum.gradient);
    if (!step.allFinite()) return std::nullopt;
    result.world_from_camera = result.world_from_camera * SE3::Exp(step);
    result.converged = step.head<3>().norm() < 1e-6 && step.tail<3>().norm() < 1e-5;
  }
  return result;
}

}  // namespace recollect::matching
