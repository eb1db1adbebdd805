#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "recollect/geometry/camera.h"
#include "recollect/geometry/se3.h"

namespace recollect::simulation {

// One drive along a route: where the car was, when. World: metres, x north, y west, z up. Car:
// x forward, y left, z up, origin on the road below its rear axle.
struct Drive {
  int number = 0;
  std::vector<double> times;  // seconds since 1970, UTC; increasing
  std::vector<SE3> world_from_car;
};

// What is driven and where on Earth it lies. The world's origin is `origin_utm` (northing,
// easting; zone 24 south): local coordinates keep their precision as floats.
struct Route {
  std::string name;
  std::vector<Eigen::Vector3d> way;  // the line that the road is laid along, points 1 m apart
  std::vector<Drive> drives;         // recorded drives; empty where drives are made up on demand
  Eigen::Vector2d origin_utm = {7757729.0, 363562.0};
  std::vector<Eigen::Vector3d> registration;  // key places of an earlier, unrendered drive

  // The drive of a lap, recorded or made up (lap >= 1, any number): made-up ones follow the way
  // within kLargestSway to its sides, at about 6 m/s, on a day of their own.
  Drive DriveOf(int lap, std::uint64_t seed) const;
};
constexpr double kLargestSway = 0.9;  // metres

// A closed ring of about 400 m with gentle slopes; its shape follows from the seed.
Route RingRoute(std::uint64_t seed);

// The recorded drives of the UFES-LAPS folder (`camerapos-*.txt`): lap 1 is the earliest but for
// the registration lap of 2014. Throws Error where there are none.
Route UfesRoute(const std::filesystem::path& folder);

// The positions of a TUM trajectory as a way; z up, headings follow the way. Throws Error, naming
// the file, for less than 20 m of it, jumps of more than 20 m, slopes steeper than 30 % and
// crossings of itself at different heights.
Route TumRoute(const std::filesystem::path& file);

// The left camera of UFES-LAPS and its place on the car.
StereoCamera UfesCamera();
SE3 UfesCarFromCamera();

// Points every `step` metres along a polyline.
std::vector<Eigen::Vector3d> Resample(const std::vector<Eigen::Vector3d>& line, double step);

}  // namespace recollect::simulation
