#pragma once

#include <Eigen/Core>

namespace recollect {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

// Skew-symmetric matrix with Hat(a) * b = a x b.
Eigen::Matrix3d Hat(const Eigen::Vector3d& a);

// Rodrigues' formula: rotation by |w| radians about w; a series near zero.
Eigen::Matrix3d ExpSo3(const Eigen::Vector3d& w);

// Rotation vector of R, |w| in [0, pi]; exact near zero and near pi.
Eigen::Vector3d LogSo3(const Eigen::Matrix3d& R);

// d Exp(w + dw) = Exp(J_l(w) dw) Exp(w), and the inverse of J_l.
Eigen::Matrix3d LeftJacobianSo3(const Eigen::Vector3d& w);
Eigen::Matrix3d LeftJacobianInverseSo3(const Eigen::Vector3d& w);

// A rigid motion. Named a_from_b it takes coordinates in frame b to frame a:
// p_a = a_from_b * p_b, and a_from_c = a_from_b * b_from_c. Metres.
// Tangent vectors are (rotation, translation), the order of the network's output.
class SE3 {
 public:
  SE3() : R_(Eigen::Matrix3d::Identity()), t_(Eigen::Vector3d::Zero()) {}
  SE3(const Eigen::Matrix3d& R, const Eigen::Vector3d& t) : R_(R), t_(t) {}

  // The SE3 layer of the paper: [Exp(w) | t] from (w, t), translation taken as is.
  static SE3 FromRotationVector(const Eigen::Vector3d& w, const Eigen::Vector3d& t) {
    return {ExpSo3(w), t};
  }
  // The group's exponential: [Exp(w) | J_l(w) v] from (w, v).
  static SE3 Exp(const Vector6d& xi);
  Vector6d Log() const;

  const Eigen::Matrix3d& rotation() const { return R_; }
  const Eigen::Vector3d& translation() const { return t_; }
  Eigen::Vector3d RotationVector() const { return LogSo3(R_); }
  // Angle of the rotation, radians in [0, pi].
  double Angle() const { return RotationVector().norm(); }

  SE3 Inverse() const { return {R_.transpose(), -(R_.transpose() * t_)}; }
  SE3 operator*(const SE3& other) const { return {R_ * other.R_, R_ * other.t_ + t_}; }
  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return R_ * p + t_; }
  Eigen::Matrix4d Matrix() const;

  // X Exp(xi) X^-1 = Exp(Adjoint() * xi).
  Matrix6d Adjoint() const;

 private:
  Eigen::Matrix3d R_;
  Eigen::Vector3d t_;
};

// Exp(xi + dxi) = Exp(J_l(xi) dxi) Exp(xi), and the inverse of J_l.
Matrix6d LeftJacobianSe3(const Vector6d& xi);
Matrix6d LeftJacobianInverseSe3(const Vector6d& xi);

// True where R is a rotation: finite, orthonormal within `tolerance`, determinant +1.
bool IsRotation(const Eigen::Matrix3d& R, double tolerance = 1e-3);

// The rotation nearest to R in the Frobenius norm.
Eigen::Matrix3d NearestRotation(const Eigen::Matrix3d& R);

// The pose a share s of the way from a (s = 0) to b (s = 1): rotation and translation each along
// its own shortest path.
SE3 Interpolate(const SE3& a, const SE3& b, double s);

}  // namespace recollect
