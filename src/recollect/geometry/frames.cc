#include "recollect/geometry/frames.h"

#include <algorithm>
#include <cmath>

namespace recollect {

Eigen::Matrix3d RotationFromRollPitchYaw(double roll, double pitch, double yaw) {
  return ExpSo3({0, 0, yaw}) * ExpSo3({0, pitch, 0}) * ExpSo3({roll, 0, 0});
}

Eigen::Vector3d RollPitchYaw(const Eigen::Matrix3d& R) {
  return {std::atan2(R(2, 1), R(2, 2)), std::asin(std::clamp(-R(2, 0), -1.0, 1.0)),
          std::atan2(R(1, 0), R(0, 0))};
}

Eigen::Matrix3d VehicleFromCameraAxes() {
  Eigen::Matrix3d R;
  R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return R;
}

SE3 VehicleFromCamera(const Eigen::Vector3d& position, double roll, double pitch, double yaw) {
  return {RotationFromRollPitchYaw(roll, pitch, yaw) * VehicleFromCameraAxes(), position};
}

SE3 UfesVehicleFromCamera() {
  return VehicleFromCamera({0.817, -0.04, 1.88}, -0.0175, 0.026, -0.0236);
}

}  // namespace recollect
