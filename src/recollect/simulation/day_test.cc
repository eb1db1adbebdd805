#include "recollect/simulation/day.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "recollect/core/error.h"

namespace recollect::simulation {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

TEST(Sun, DeclinationOfAWorkedExample) {
  // Meeus, Astronomical Algorithms, example 25.a: 1992 October 13, 0 h: declination -7.785 degrees,
  // which is the sun's elevation at the north pole.
  const SunPosition sun = SunAt(UnixTime(1992, 10, 13, 0, 0), std::numbers::pi / 2, 0);
  EXPECT_NEAR(sun.elevation / kDegree, -7.785, 0.02);
}

TEST(Sun, CulminatesOverTheCampusAtTheSolstice) {
  double highest = -1, when = 0;
  for (int minute = 0; minute < 1440; ++minute) {
    const double time = UnixTime(2017, 12, 21, 0, minute);
    const double elevation = SunAt(time, kCampusLatitude, kCampusLongitude).elevation;
    if (elevation > highest) highest = elevation, when = minute / 60.0;
  }
  EXPECT_NEAR(highest / kDegree, 90 - (23.436 - 20.27), 0.05);
  EXPECT_NEAR(when, 12 + 40.30 / 15 - 0.03, 0.1);  // 40.3 degrees west, equation of time 2 minutes
}

TEST(Sun, RisesInTheEastAndSetsInTheWest) {
  const double morning =
      SunAt(UnixTime(2016, 9, 22, 9, 30), kCampusLatitude, kCampusLongitude).azimuth;
  const double evening =
      SunAt(UnixTime(2016, 9, 22, 20, 0), kCampusLatitude, kCampusLongitude).azimuth;
  EXPECT_NEAR(morning / kDegree, 87, 8);
  EXPECT_NEAR(evening / kDegree, -87, 8);
  // World x is north and y west: the morning sun shines from negative y.
  EXPECT_LT(MakeDay(UnixTime(2016, 9, 22, 9, 30), {}, Weather::kClear, 1).to_sun.y(), -0.8F);
}

TEST(Day, StrengthSqueezesTheSameHistory) {
  Day day = MakeDay(UnixTime(2018, 1, 12, 18, 0), {}, Weather::kClear, 1);
  int before = 0, total = 0;
  for (const double strength : {0.0, 0.5, 1.0, 2.0, 4.0}) {
    day.change.strength = strength;
    int count = 0;
    for (std::uint64_t id = 0; id < 500; ++id) count += day.Changes(id, 0.25);
    EXPECT_GE(count, before);
    if (strength == 1.0) total = count;
    before = count;
  }
  EXPECT_NEAR(total / 500.0, 0.25 * 4.03, 0.15);  // four years at a rate of one in four
  day.change.structures = false;
  EXPECT_EQ(day.Changes(3, 100), 0);
}

TEST(Day, LightCanBeSwitchedOff) {
  Change fixed;
  fixed.light = false;
  const Day a = MakeDay(UnixTime(2016, 8, 25, 18, 31), fixed, Weather::kByDay, 1);
  const Day b = MakeDay(UnixTime(2017, 12, 5, 11, 35), fixed, Weather::kByDay, 1);
  EXPECT_EQ(a.to_sun, b.to_sun);
  EXPECT_EQ(a.weather, b.weather);
  EXPECT_EQ(a.cloud, b.cloud);
  const Day c = MakeDay(UnixTime(2017, 12, 5, 11, 35), {}, Weather::kByDay, 1);
  EXPECT_NE(c.to_sun, b.to_sun);
}

TEST(Day, RefusesNonsense) {
  EXPECT_THROW(ParseWeather("snow"), Error);
  Change change;
  change.strength = -1;
  EXPECT_THROW(MakeDay(0, change, Weather::kClear, 1), Error);
  EXPECT_EQ(ParseWeather("mist"), Weather::kMist);
}

}  // namespace
}  // namespace recollect::simulation
