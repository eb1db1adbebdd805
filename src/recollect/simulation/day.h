#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "recollect/simulation/mesh.h"

namespace recollect::simulation {

// Seconds since 1970 of a date and time in UTC.
double UnixTime(int year, int month, int day, int hour, int minute);

// Where the sun stands: azimuth clockwise from north and elevation above the horizon, radians,
// without refraction. `unix_time` in seconds UTC, place in radians (north and east positive). By
// the Astronomical Almanac's low-precision formulas: within 0.02 degrees from 1950 to 2050.
struct SunPosition {
  double azimuth, elevation;
};
SunPosition SunAt(double unix_time, double latitude, double longitude);

// The campus: 20.27 S, 40.30 W.
constexpr double kCampusLatitude = -20.27 * 3.14159265358979 / 180;
constexpr double kCampusLongitude = -40.30 * 3.14159265358979 / 180;

enum class Weather { kByDay, kClear, kFair, kOvercast, kRain, kMist };
// "day", "clear", "fair", "overcast", "rain" or "mist"; kByDay draws one for each day. Throws
// Error for anything else.
Weather ParseWeather(std::string_view name);
std::string Name(Weather weather);

// How much the world differs between days, and in what.
struct Change {
  // 0: nothing but the laps' own poses differs; scales rates and amounts. The default makes places
  // about as hard to recognise as the paper's real ones (docs/simulation.md).
  double strength = 1.75;
  bool light = true;       // time of day, weather, camera settings; else a fair noon
  bool structures = true;  // buildings, paint, trees, signs, fences, kiosks come, go and change
  bool traffic = true;     // parked and moving cars, pedestrians
  bool season = true;      // colour and fullness of leaves and grass
};

// All that sets one day apart from another.
struct Day {
  double unix_time = 0;
  Weather weather = Weather::kFair;
  Vec3 to_sun = Vec3::UnitZ();
  float cloud = 0.3F;       // share of the sky, 0..1
  float wetness = 0;        // 0 dry, 1 wet road
  float visibility = 8000;  // metres until haze leaves 5 % contrast
  float dryness = 0;        // 0: rains just over, lush; 1: end of the dry winter
  std::uint64_t seed = 0;   // of all that differs between days for no reason
  Change change;

  // How often the thing `id`, changing `rate` times a year at strength 1, has changed since the
  // beginning of 2014; with structures switched off, never.
  int Changes(std::uint64_t id, double rate) const;
  // A number in [0, 1) that belongs to this day and `key`; with `same` the same on all days.
  double Draw(std::uint64_t key, bool same = false) const;
};

// The day of a drive that begins at `unix_time`. The world's x is north, its y west.
Day MakeDay(double unix_time, const Change& change, Weather weather, std::uint64_t seed);

}  // namespace recollect::simulation
