#pragma once

#include <functional>
#include <string>
#include <vector>

#include "recollect/dataset/lap.h"
#include "recollect/simulation/route.h"

namespace recollect::simulation {

// Where on Earth a point of the world is: WGS 84, degrees.
struct Geodetic {
  double latitude, longitude;
};
// From UTM coordinates of zone 24 south, metres; within a centimetre over the zone.
Geodetic FromUtm(double northing, double easting);

// Satellite fixes at the given times and positions. Quality falls where little of the sky is seen:
// `open_sky` tells the share of it (0..1) at a position. About 78.5 % of the fixes have quality 4,
// 2.5 % quality 5, 8.5 % quality 2 and 10.3 % none, in stretches; horizontal errors wander slowly
// and average 0.20 m for quality 4 and 0.60 m for 5 and 2, as on the UFES test lap.
std::vector<GpsFix> SimulateGps(const std::vector<double>& times,
                                const std::vector<Eigen::Vector3d>& positions,
                                const std::function<double(const Eigen::Vector3d&)>& open_sky,
                                std::uint64_t seed);

// One NMEA GGA sentence, with its check sum, without line end. `clock`: seconds since 1970, UTC.
std::string GgaSentence(const GpsFix& fix, double clock, const Eigen::Vector2d& origin_utm);

// What the wheels say: speed (m/s) and steering angle (radians, left positive) of the front wheels
// of a car with a wheelbase of 2.625 m.
struct WheelReading {
  double time, speed, steering;
};
// Readings at the drive's poses: speed with a scale error of up to 1 % and noise of 0.05 m/s,
// steering with a bias of up to 0.3 degrees and noise of 0.2 degrees.
std::vector<WheelReading> SimulateWheels(const Drive& drive, std::uint64_t seed);

}  // namespace recollect::simulation
