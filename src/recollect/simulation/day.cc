#include "recollect/simulation/day.h"

#include <array>
#include <chrono>
#include <cmath>
#include <numbers>
#include <utility>

#include "recollect/core/error.h"
#include "recollect/core/random.h"

namespace recollect::simulation {
namespace {

constexpr double kYear = 365.25 * 86400;

constexpr std::array<std::pair<Weather, const char*>, 6> kNames = {
    {{Weather::kByDay, "day"},
     {Weather::kClear, "clear"},
     {Weather::kFair, "fair"},
     {Weather::kOvercast, "overcast"},
     {Weather::kRain, "rain"},
     {Weather::kMist, "mist"}}};

Weather DrawWeather(double u) {
  if (u < 0.3) return Weather::kClear;
  if (u < 0.7) return Weather::kFair;
  if (u < 0.88) return Weather::kOvercast;
  return u < 0.95 ? Weather::kRain : Weather::kMist;
}

}  // namespace

double UnixTime(int year, int month, int day, int hour, int minute) {
  using namespace std::chrono;
  const sys_days date = std::chrono::year(year) / month / day;
  return static_cast<double>(date.time_since_epoch().count()) * 86400.0 + hour * 3600 + minute * 60;
}

SunPosition SunAt(double unix_time, double latitude, double longitude) {
  constexpr double kDegree = std::numbers::pi / 180;
  const double days = unix_time / 86400 + 2440587.5 - 2451545.0;  // since noon of 2000-01-01
  const double mean_longitude = 280.460 + 0.9856474 * days;
  const double anomaly = (357.528 + 0.9856003 * days) * kDegree;
  const double ecliptic =
      (mean_longitude + 1.915 * std::sin(anomaly) + 0.020 * std::sin(2 * anomaly)) * kDegree;
  const double tilt = (23.439 - 0.0000004 * days) * kDegree;
  const double declination = std::asin(std::sin(tilt) * std::sin(ecliptic));
  const double ascension = std::atan2(std::cos(tilt) * std::sin(ecliptic), std::cos(ecliptic));
  const double sidereal = (280.46062 + 360.98564737 * days) * kDegree;
  const double hour_angle = sidereal + longitude - ascension;
  const double elevation =
      std::asin(std::sin(latitude) * std::sin(declination) +
                std::cos(latitude) * std::cos(declination) * std::cos(hour_angle));
  const double azimuth =
      std::atan2(-std::cos(declination) * std::sin(hour_angle),
                 std::cos(latitude) * std::sin(declination) -
                     std::sin(latitude) * std::cos(declination) * std::cos(hour_angle));
  return {azimuth, elevation};
}

Weather ParseWeather(std::string_view name) {
  for (const auto& [weather, known] : kNames) {
    if (name == known) return weather;
  }
  throw Error("weather", fmt::format("'{}' is not known", name),
              "take day, clear, fair, overcast, rain or mist");
}

std::string Name(Weather weather) {
  for (const auto& [known, name] : kNames) {
    if (weather == known) return name;
  }
  return "?";
}

int Day::Changes(std::uint64_t id, double rate) const {
  if (!change.structures || change.strength <= 0) return 0;
  // Gaps between changes are exponential. The draws do not depend on the strength, so a stronger
  // change only squeezes the same history.
  const double end = (unix_time - UnixTime(2014, 1, 1, 0, 0)) / kYear * rate * change.strength;
  int count = 0;
  for (double t = 0; count < 64; ++count) {
    const auto bits = SubSeed(id, static_cast<std::uint64_t>(count)) >> 11;
    t -= std::log(1 - static_cast<double>(bits) * 0x1.0p-53);
    if (t > end) break;
  }
  return count;
}

double Day::Draw(std::uint64_t key, bool same) const {
  return static_cast<double>(SubSeed(same ? 0 : seed, key) >> 11) * 0x1.0p-53;
}

Day MakeDay(double unix_time, const Change& change, Weather weather, std::uint64_t seed) {
  Require(change.strength >= 0 && change.strength <= 10, "change",
          fmt::format("{} is out of range", change.strength), "take 0 (no change) to 10");
  Day day;
  day.unix_time = unix_time;
  day.change = change;
  day.seed = SubSeed(seed, static_cast<std::uint64_t>(std::floor(unix_time / 60)));
  const bool lit = change.light && change.strength > 0;
  day.weather = weather;
  if (weather == Weather::kByDay) {
    day.weather = lit ? DrawWeather(day.Draw(1)) : Weather::kFair;
  }
  const auto draw = [&](std::uint64_t key, double low, double high) {
    return static_cast<float>(low + (high - low) * day.Draw(key, !lit));
  };
  day.visibility = draw(2, 4000, 14000);
  switch (day.weather) {
    case Weather::kClear:
      day.cloud = draw(3, 0.0, 0.15);
      break;
    case Weather::kFair:
      day.cloud = draw(3, 0.25, 0.55);
      break;
    case Weather::kOvercast:
      day.cloud = draw(3, 0.88, 1.0);
      break;
    case Weather::kRain:
      day.cloud = 1, day.wetness = 1, day.visibility = draw(2, 800, 2500);
      break;
    default:
      day.cloud = 0.8F, day.wetness = 0.4F, day.visibility = draw(2, 250, 700);
      break;
  }
  // With the light switched off it is always 10:00 of an equinox.
  const double clock = lit ? unix_time : UnixTime(2016, 9, 22, 13, 0);
  const SunPosition sun = SunAt(clock, kCampusLatitude, kCampusLongitude);
  day.to_sun = Vec3(static_cast<float>(std::cos(sun.elevation) * std::cos(sun.azimuth)),
                    static_cast<float>(-std::cos(sun.elevation) * std::sin(sun.azimuth)),
                    static_cast<float>(std::sin(sun.elevation)));
  // Rain falls from November to March; September is the driest.
  if (change.season) {
    const double phase = 2 * std::numbers::pi * (unix_time - UnixTime(2016, 9, 5, 0, 0)) / kYear;
    day.dryness =
        static_cast<float>((0.5 + 0.5 * std::cos(phase)) * std::min(1.0, change.strength));
  }
  return day;
}

}  // namespace recollect::simulation
