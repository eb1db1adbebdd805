#include "recollect/geometry/se3.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cmath>

namespace recollect {
namespace {

// Below this squared angle the closed forms lose digits and their series are exact in double.
constexpr double kSmall = 1e-8;

// Coefficients of I, Hat and Hat^2 in Exp, J_l and their kin.
double SinOver(double t2) {
  return t2 < kSmall ? 1 - t2 / 6 : std::sin(std::sqrt(t2)) / std::sqrt(t2);
}
double OneMinusCosOver(double t2) {
  // As twice the squared sine of the half angle: no digits cancel.
  const double half = SinOver(t2 / 4);
  return half * half / 2;
}
double ThetaMinusSinOver(double t2) {
  const double t = std::sqrt(t2);
  return t2 < 1e-4 ? 1.0 / 6 - t2 / 120 + t2 * t2 / 5040 : (t - std::sin(t)) / (t2 * t);
}

}  // namespace

Eigen::Matrix3d Hat(const Eigen::Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

Eigen::Matrix3d ExpSo3(const Eigen::Vector3d& w) {
  const double t2 = w.squaredNorm();
  const Eigen::Matrix3d W = Hat(w);
  return Eigen::Matrix3d::Identity() + SinOver(t2) * W + OneMinusCosOver(t2) * W * W;
}

Eigen::Vector3d LogSo3(const Eigen::Matrix3d& R) {
  // Through the quaternion: unlike the trace it keeps its digits both near zero and near pi.
  Eigen::Quaterniond q(R);
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double sine = q.vec().norm();
  if (sine < 1e-10) return 2 * q.vec() / q.w();
  return 2 * std::atan2(sine, q.w()) / sine * q.vec();
}

Eigen::Matrix3d LeftJacobianSo3(const Eigen::Vector3d& w) {
  const double t2 = w.squaredNorm();
  const Eigen::Matrix3d W = Hat(w);
  return Eigen::Matrix3d::Identity() + OneMinusCosOver(t2) * W + ThetaMinusSinOver(t2) * W * W;
}

Eigen::Matrix3d LeftJacobianInverseSo3(const Eigen::Vector3d& w) {
  const double t2 = w.squaredNorm();
  const double t = std::sqrt(t2);
  const Eigen::Matrix3d W = Hat(w);
  // (1 + cos t) / sin t is written as 1 / tan(t / 2), which keeps its digits at pi.
  const double c =
      t2 < 1e-4 ? 1.0 / 12 + t2 / 720 + t2 * t2 / 30240 : 1 / t2 - 1 / (2 * t * std::tan(t / 2));
  return Eigen::Matrix3d::Identity() - 0.5 * W + c * W * W;
}

SE3 SE3::Exp(const Vector6d& xi) {
  return {ExpSo3(xi.head<3>()), LeftJacobianSo3(xi.head<3>()) * xi.tail<3>()};
}

Vector6d SE3::Log() const {
  Vector6d xi;
  xi.head<3>() = LogSo3(R_);
  xi.tail<3>() = LeftJacobianInverseSo3(xi.head<3>()) * t_;
  return xi;
}

Eigen::Matrix4d SE3::Matrix() const {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = R_;
  m.topRightCorner<3, 1>() = t_;
  return m;
}

Matrix6d SE3::Adjoint() const {
  Matrix6d adjoint = Matrix6d::Zero();
  adjoint.topLeftCorner<3, 3>() = R_;
  adjoint.bottomRightCorner<3, 3>() = R_;
  adjoint.bottomLeftCorner<3, 3>() = Hat(t_) * R_;
  return adjoint;
}

namespace {

// The lower left block of the left Jacobian of SE(3) (Barfoot 2017, eq. 7.86b, with rotation
// and translation swapped).
Eigen::Matrix3d JacobianCross(const Vector6d& xi) {
  const Eigen::Matrix3d W = Hat(xi.head<3>()), V = Hat(xi.tail<3>());
  const double t2 = xi.head<3>().squaredNorm(), t = std::sqrt(t2);
  const bool small = t2 < 1e-3;
  const double a = ThetaMinusSinOver(t2);
  const double b =
      small ? 1.0 / 24 - t2 / 720 + t2 * t2 / 40320 : (t2 / 2 + std::cos(t) - 1) / (t2 * t2);
  const double c = small ? 1.0 / 120 - t2 / 2520 + t2 * t2 / 120960
                         : (2 * t - 3 * std::sin(t) + t * std::cos(t)) / (2 * t2 * t2 * t);
  return 0.5 * V + a * (W * V + V * W + W * V * W) + b * (W * W * V + V * W * W - 3 * W * V * W) +
         c * (W * V * W * W + W * W * V * W);
}

}  // namespace

Matrix6d LeftJacobianSe3(const Vector6d& xi) {
  Matrix6d jacobian = Matrix6d::Zero();
  jacobian.topLeftCorner<3, 3>() = LeftJacobianSo3(xi.head<3>());
  jacobian.bottomRightCorner<3, 3>() = jacobian.topLeftCorner<3, 3>();
  jacobian.bottomLeftCorner<3, 3>() = JacobianCross(xi);
  return jacobian;
}

Matrix6d LeftJacobianInverseSe3(const Vector6d& xi) {
  const Eigen::Matrix3d inverse = LeftJacobianInverseSo3(xi.head<3>());
  Matrix6d jacobian = Matrix6d::Zero();
  jacobian.topLeftCorner<3, 3>() = inverse;
  jacobian.bottomRightCorner<3, 3>() = inverse;
  jacobian.bottomLeftCorner<3, 3>() = -inverse * JacobianCross(xi) * inverse;
  return jacobian;
}

bool IsRotation(const Eigen::Matrix3d& R, double tolerance) {
  return R.allFinite() &&
         (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= tolerance &&
         R.determinant() > 0;
}

Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& R) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d D = Eigen::Matrix3d::Identity();
  D(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * D * svd.matrixV().transpose();
}

SE3 Interpolate(const SE3& a, const SE3& b, double s) {
  const Eigen::Vector3d w = LogSo3(a.rotation().transpose() * b.rotation());
  return {a.rotation() * ExpSo3(s * w), (1 - s) * a.translation() + s * b.translation()};
}

}  // namespace recollect
