#include "recollect/geometry/se3.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "recollect/core/random.h"

namespace recollect {
namespace {

constexpr double kPi = std::numbers::pi;

Eigen::Vector3d RandomUnit(Random& random) {
  return Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal()).normalized();
}

// Tangent vectors with rotations from none to nearly a half turn, about random axes.
std::vector<Vector6d> Tangents() {
  Random random(3);
  std::vector<Vector6d> tangents;
  for (const double angle : {0.0, 1e-12, 1e-8, 1e-5, 1e-4, 0.009, 0.011, 0.03, 0.032, 0.5, 2.0, 3.1,
                             kPi - 1e-3, kPi - 1e-6, kPi - 1e-9}) {
    for (int i = 0; i < 5; ++i) {
      Vector6d xi;
      xi.head<3>() = angle * RandomUnit(random);
      xi.tail<3>() = 3 * RandomUnit(random);
      tangents.push_back(xi);
    }
  }
  return tangents;
}

// Column i is (f(h e_i) - f(-h e_i)) / 2h.
Matrix6d NumericJacobian(const std::function<Vector6d(const Vector6d&)>& f, double h = 1e-5) {
  Matrix6d jacobian;
  for (int i = 0; i < 6; ++i) {
    const Vector6d step = h * Vector6d::Unit(i);
    jacobian.col(i) = (f(step) - f(-step)) / (2 * h);
  }
  return jacobian;
}

double Distance(const SE3& a, const SE3& b) { return (a.Matrix() - b.Matrix()).norm(); }

TEST(So3, ExpIsARotationByTheAngle) {
  for (const Vector6d& xi : Tangents()) {
    const Eigen::Vector3d w = xi.head<3>();
    const Eigen::Matrix3d R = ExpSo3(w);
    EXPECT_TRUE(IsRotation(R, 1e-14));
    EXPECT_LT((R * w - w).norm(), 1e-14);
    EXPECT_NEAR(R.trace(), 1 + 2 * std::cos(w.norm()), 1e-14);
  }
}

TEST(So3, ExpOfQuarterTurnAboutZTakesXToY) {
  EXPECT_LT((ExpSo3({0, 0, kPi / 2}) * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(),
            1e-15);
}

TEST(So3, LogInvertsExp) {
  for (const Vector6d& xi : Tangents()) {
    const Eigen::Vector3d w = xi.head<3>();
    EXPECT_LT((LogSo3(ExpSo3(w)) - w).norm(), 1e-13) << w.norm();
  }
}

TEST(So3, LogOfAHalfTurnIsPiAboutEitherEndOfTheAxis) {
  Random random(5);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d axis = RandomUnit(random);
    const Eigen::Vector3d w = LogSo3(2 * axis * axis.transpose() - Eigen::Matrix3d::Identity());
    EXPECT_NEAR(w.norm(), kPi, 1e-14);
    EXPECT_NEAR(std::abs(w.dot(axis)), kPi, 1e-13);
  }
}

TEST(So3, LogOfMoreThanAHalfTurnGoesTheShortWay) {
  const Eigen::Vector3d axis(0, 0.6, 0.8);
  EXPECT_LT((LogSo3(ExpSo3((kPi + 0.1) * axis)) + (kPi - 0.1) * axis).norm(), 1e-14);
}

TEST(Se3, LogInvertsExp) {
  for (const Vector6d& xi : Tangents()) {
    EXPECT_LT((SE3::Exp(xi).Log() - xi).norm(), 1e-12) << xi.head<3>().norm();
  }
}

TEST(Se3, LeftJacobianIsTheDerivativeOfExp) {
  for (const Vector6d& xi : Tangents()) {
    const SE3 inverse = SE3::Exp(xi).Inverse();
    const Matrix6d numeric =
        NumericJacobian([&](const Vector6d& d) { return (SE3::Exp(xi + d) * inverse).Log(); });
    EXPECT_LT((LeftJacobianSe3(xi) - numeric).norm(), 1e-8) << xi.head<3>().norm();
    const Eigen::Matrix3d so3 = LeftJacobianSo3(xi.head<3>());
    EXPECT_LT((so3 - numeric.topLeftCorner<3, 3>()).norm(), 1e-8);
  }
}

TEST(Se3, LeftJacobianInverseIsTheInverse) {
  for (const Vector6d& xi : Tangents()) {
    EXPECT_LT((LeftJacobianSe3(xi) * LeftJacobianInverseSe3(xi) - Matrix6d::Identity()).norm(),
              1e-11)
        << xi.head<3>().norm();
  }
}

TEST(Se3, AdjointMovesATangentThroughAPose) {
  const std::vector<Vector6d> tangents = Tangents();
  for (std::size_t i = 0; i + 7 < tangents.size(); ++i) {
    const SE3 pose = SE3::Exp(tangents[i + 7]);
    const Vector6d xi = 0.5 * tangents[i];
    EXPECT_LT(Distance(pose * SE3::Exp(xi) * pose.Inverse(), SE3::Exp(pose.Adjoint() * xi)), 1e-12);
  }
}

TEST(Se3, ComposesAndInverts) {
  for (const Vector6d& xi : Tangents()) {
    const SE3 a = SE3::Exp(xi), b = SE3::FromRotationVector({0.1, -0.2, 0.3}, {1, 2, 3});
    const Eigen::Vector3d p(-1, 5, 2);
    EXPECT_LT(((a * b) * p - a * (b * p)).norm(), 1e-13);
    EXPECT_LT(Distance(a * a.Inverse(), SE3()), 1e-13);
    EXPECT_EQ(b.translation(), Eigen::Vector3d(1, 2, 3));
  }
}

TEST(Se3, InterpolateMovesEvenlyFromEndToEnd) {
  const SE3 a = SE3::FromRotationVector({0, 0, 3}, {1, 0, 0});
  const SE3 b = SE3::FromRotationVector({0, 0, -3}, {3, 4, 0});  // the short way is over pi
  EXPECT_LT(Distance(Interpolate(a, b, 0), a), 1e-14);
  EXPECT_LT(Distance(Interpolate(a, b, 1), b), 1e-14);
  const SE3 middle = Interpolate(a, b, 0.5);
  EXPECT_LT((middle.translation() - Eigen::Vector3d(2, 2, 0)).norm(), 1e-15);
  EXPECT_LT((middle.rotation() - ExpSo3({0, 0, kPi})).norm(), 1e-14);
}

TEST(Rotation, IsToldFromOtherMatrices) {
  const Eigen::Matrix3d R = ExpSo3({0.3, -0.2, 1});
  EXPECT_TRUE(IsRotation(R));
  EXPECT_FALSE(IsRotation(-R));
  EXPECT_FALSE(IsRotation(1.01 * R));
  EXPECT_FALSE(IsRotation(R * std::numeric_limits<double>::quiet_NaN()));
}

TEST(Rotation, NearestIsARotationCloseBy) {
  const Eigen::Matrix3d R = ExpSo3({0.3, -0.2, 1});
  Eigen::Matrix3d noisy = R;
  noisy(0, 1) += 1e-3;
  const Eigen::Matrix3d nearest = NearestRotation(noisy);
  EXPECT_TRUE(IsRotation(nearest, 1e-14));
  EXPECT_LT((nearest - R).norm(), 1e-3);
  EXPECT_LT((NearestRotation(2 * R) - R).norm(), 1e-14);
  EXPECT_TRUE(IsRotation(NearestRotation(-R), 1e-14));
}

}  // namespace
}  // namespace recollect
