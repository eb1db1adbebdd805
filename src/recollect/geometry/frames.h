#pragma once

#include "recollect/geometry/se3.h"

namespace recollect {

// Frames of this project. World: metres, z up where the data set says so. Vehicle: x forward,
// y left, z up. Camera: x right, y down, z forward.

// Rz(yaw) Ry(pitch) Rx(roll): first roll about x, then pitch about y, then yaw about z, all axes
// fixed. Positive yaw turns left, positive pitch lowers the nose. Radians.
Eigen::Matrix3d RotationFromRollPitchYaw(double roll, double pitch, double yaw);

// The inverse of it: (roll, pitch, yaw) with pitch in [-pi/2, pi/2], the others in [-pi, pi].
Eigen::Vector3d RollPitchYaw(const Eigen::Matrix3d& R);

// The turn from camera axes to vehicle axes of a camera that looks straight ahead.
Eigen::Matrix3d VehicleFromCameraAxes();

// A camera at (x, y, z) on the vehicle, turned by (roll, pitch, yaw) from straight ahead.
SE3 VehicleFromCamera(const Eigen::Vector3d& position, double roll, double pitch, double yaw);

// UFES-LAPS. The world is north-west-up: x is the UTM northing, y minus the easting (zone 24K),
// z up and 0 all along. Poses are the car's, R = Rz(rz) Ry(ry) Rx(rx). The stereo camera's left
// eye sits on the car as its authors measured it.
SE3 UfesVehicleFromCamera();

}  // namespace recollect
