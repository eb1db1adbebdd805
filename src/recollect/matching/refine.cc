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

// Of each observation, as a camera at about `pose` sees it.
std::vector<Eigen::Matrix2d> Informations(std::span<const Observation> observations,
                                          const PinholeCamera& camera, const SE3& pose) {
  const SE3 camera_from_world = pose.Inverse();
  std::vector<Eigen::Matrix2d> informations;
  informations.reserve(observations.size());
  for (const Observation& o : observations) {
    Eigen::Vector3d p = camera_from_world * o.p_world;
    p.z() = std::max(p.z(), kNearest);
    informations.push_back(
        Information(o, ProjectionJacobian(camera, p), camera_from_world.rotation()));
  }
  return informations;
}

struct NormalEquations {
  Matrix6d hessian = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
};

// gradients: each observation's part, where asked for.
NormalEquations Linearise(std::span<const Observation> observations,
                          const std::vector<Eigen::Matrix2d>& informations,
                          const PinholeCamera& camera, const SE3& pose,
                          const RefineOptions& options, std::vector<double>& deviations,
                          std::vector<Vector6d>* gradients) {
  NormalEquations sum;
  const SE3 camera_from_world = pose.Inverse();
  deviations.assign(observations.size(), std::numeric_limits<double>::infinity());
  if (gradients != nullptr) gradients->assign(observations.size(), Vector6d::Zero());
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const Observation& o = observations[i];
    const Eigen::Vector3d p = camera_from_world * o.p_world;
    if (p.z() < kNearest) continue;
    const Eigen::Matrix<double, 2, 6> jacobian = PoseJacobian(ProjectionJacobian(camera, p), p);
    const Eigen::Vector2d r = camera.Project(p) - o.pixel;
    const double squared = r.dot(informations[i] * r);
    deviations[i] = std::sqrt(squared);
    const double weight = 1 / (1 + squared / (options.robust_scale * options.robust_scale));
    const Eigen::Matrix<double, 6, 2> weighed = weight * jacobian.transpose() * informations[i];
    const Vector6d gradient = weighed * r;
    sum.hessian += weighed * jacobian;
    sum.gradient += gradient;
    if (gradients != nullptr) (*gradients)[i] = gradient;
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
// Observation; -1 is a cluster by itself), and how many clusters there are. spent: degrees of
// freedom that the pose took.
std::pair<Matrix6d, double> Scatter(std::span<const Observation> observations,
                                    const std::vector<Vector6d>& gradients,
                                    int Observation::*cluster, int spent) {
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
  return {scatter * (clusters / std::max(1.0, clusters - spent)), clusters};
}

// Few features tell little of six dimensions: it is as if some more had scattered as the Hessian
// says.
Matrix6d Scatter(std::span<const Observation> observations, const Matrix6d& hessian,
                 const std::vector<Vector6d>& gradients) {
  const auto [by_feature, features] = Scatter(observations, gradients, &Observation::feature, 6);
  Matrix6d scatter =
      (features * by_feature + kExpectedFeatures * hessian) / (features + kExpectedFeatures);
  if (observations.empty()) return scatter;
  if (observations.front().key_frame >= 0) {
    scatter += Scatter(observations, gradients, &Observation::key_frame, 6).first;
  }
  if (observations.front().lap >= 0) {  // there are few, whose gradients make up zero together
    scatter += Scatter(observations, gradients, &Observation::lap, 1).first;
  }
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
  const auto informations = Informations(observations, camera, start);
  std::vector<Vector6d> gradients;
  for (int iteration = 0; iteration <= options.max_iterations; ++iteration) {
    const bool last = result.converged || iteration == options.max_iterations;
    NormalEquations sum = Linearise(observations, informations, camera, result.world_from_camera,
                                    options, result.deviations, last ? &gradients : nullptr);
    Matrix6d scatter;
    if (last) scatter = Scatter(observations, sum.hessian, gradients);
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
    // As the Hessian has it, the step's length in standard deviations.
    result.converged = -step.dot(sum.gradient) < options.smallest_step * options.smallest_step;
  }
  return result;
}

}  // namespace recollect::matching
