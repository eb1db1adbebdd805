#include "recollect/simulation/sensors.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "recollect/core/error.h"
#include "recollect/core/random.h"

namespace recollect::simulation {
namespace {

constexpr double kWheelbase = 2.625;

// A first-order random walk that forgets over `memory` steps, of standard deviation 1.
class Wander {
 public:
  Wander(Random& random, double memory)
      : random_(random), keep_(std::exp(-1 / memory)), value_(random.Normal()) {}
  double Next() {
    value_ = keep_ * value_ + std::sqrt(1 - keep_ * keep_) * random_.Normal();
    return value_;
  }

 private:
  Random& random_;
  double keep_, value_;
};

}  // namespace

Geodetic FromUtm(double northing, double easting) {
  // Krueger's series (n up to the third power) for WGS 84; zone 24: central meridian 39 W.
  constexpr double a = 6378137.0, f = 1 / 298.257223563, k0 = 0.9996;
  constexpr double n = f / (2 - f);
  constexpr double radius = a / (1 + n) * (1 + n * n / 4 + n * n * n * n / 64);
  constexpr double beta[] = {n / 2 - 2 * n * n / 3 + 37 * n * n * n / 96,
                             n * n / 48 + n * n * n / 15, 17 * n * n * n / 480};
  constexpr double delta[] = {2 * n - 2 * n * n / 3 - 2 * n * n * n,
                              7 * n * n / 3 - 8 * n * n * n / 5, 56 * n * n * n / 15};
  const double xi = (northing - 1e7) / (k0 * radius), eta = (easting - 5e5) / (k0 * radius);
  double xi1 = xi, eta1 = eta;
  for (int j = 1; j <= 3; ++j) {
    xi1 -= beta[j - 1] * std::sin(2 * j * xi) * std::cosh(2 * j * eta);
    eta1 -= beta[j - 1] * std::cos(2 * j * xi) * std::sinh(2 * j * eta);
  }
  const double chi = std::asin(std::sin(xi1) / std::cosh(eta1));
  double latitude = chi;
  for (int j = 1; j <= 3; ++j) latitude += delta[j - 1] * std::sin(2 * j * chi);
  const double longitude = std::atan2(std::sinh(eta1), std::cos(xi1));
  constexpr double kDegrees = 180 / std::numbers::pi;
  return {latitude * kDegrees, longitude * kDegrees - 39};
}

std::vector<GpsFix> SimulateGps(const std::vector<double>& times,
                                const std::vector<Eigen::Vector3d>& positions,
                                const std::function<double(const Eigen::Vector3d&)>& open_sky,
                                std::uint64_t seed) {
  const std::size_t n = times.size();
  Random random(seed);
  Wander constellation(random, 25);
  std::vector<double> reception(n);
  for (std::size_t i = 0; i < n; ++i) {
    reception[i] = open_sky(positions[i]) + 0.12 * constellation.Next();
  }
  // A receiver loses and regains its fix over some seconds, not from one frame to the next.
  std::vector<double> smooth(n);
  constexpr std::ptrdiff_t kHalf = 4;
  for (std::size_t i = 0; i < n; ++i) {
    const auto low = static_cast<std::size_t>(
        std::max<std::ptrdiff_t>(0, static_cast<std::ptrdiff_t>(i) - kHalf));
    const std::size_t high = std::min(n, i + kHalf + 1);
    smooth[i] = std::accumulate(reception.begin() + static_cast<std::ptrdiff_t>(low),
                                reception.begin() + static_cast<std::ptrdiff_t>(high), 0.0) /
                static_cast<double>(high - low);
  }
  std::vector<double> sorted = smooth;
  std::sort(sorted.begin(), sorted.end());
  const auto quantile = [&](double share) {
    return sorted[std::min(n - 1, static_cast<std::size_t>(share * static_cast<double>(n)))];
  };
  const double none = quantile(0.103), differential = quantile(0.188), floating = quantile(0.213);
  Wander north(random, 12), west(random, 12), up(random, 12);
  std::vector<GpsFix> fixes(n);
  for (std::size_t i = 0; i < n; ++i) {
    GpsFix& fix = fixes[i];
    fix.time = times[i];
    fix.quality = smooth[i] < none           ? 0
                  : smooth[i] < differential ? 2
                  : smooth[i] < floating     ? 5
                                             : 4;
    // The length of a two-dimensional normal error averages 1.2533 standard deviations.
    const double mean = fix.quality == 4 ? 0.20 : fix.quality == 0 ? 80.0 : 0.60;
    fix.p_world = positions[i] +
                  Eigen::Vector3d(north.Next(), west.Next(), 1.8 * up.Next()) * (mean / 1.2533);
  }
  return fixes;
}

std::string GgaSentence(const GpsFix& fix, double clock, const Eigen::Vector2d& origin_utm) {
  const Geodetic place =
      FromUtm(origin_utm.x() + fix.p_world.x(), origin_utm.y() - fix.p_world.y());
  const auto angle = [](double degrees, int digits) {
    const double size = std::abs(degrees), whole = std::floor(size);
    return fmt::format("{:0{}.0f}{:010.7f}", whole, digits, (size - whole) * 60);
  };
  const double day = std::fmod(clock, 86400);
  const int hour = static_cast<int>(day / 3600), minute = static_cast<int>(day / 60) % 60;
  const std::string body =
      fmt::format("GPGGA,{:02}{:02}{:05.2f},{},{},{},{},{},{:02},{:.1f},{:.3f},M,-7.0,M,{},", hour,
                  minute, std::fmod(day, 60), angle(place.latitude, 2),
                  place.latitude < 0 ? 'S' : 'N', angle(place.longitude, 3),
                  place.longitude < 0 ? 'W' : 'E', fix.quality, fix.quality == 0 ? 3 : 12,
                  fix.quality == 4 ? 0.8 : 1.9, fix.p_world.z(), fix.quality >= 2 ? "1.0" : "");
  unsigned sum = 0;
  for (const char c : body) sum ^= static_cast<unsigned char>(c);
  return fmt::format("${}*{:02X}", body, sum);
}

std::vector<WheelReading> SimulateWheels(const Drive& drive, std::uint64_t seed) {
  Random random(seed);
  const double scale = 1 + random.Uniform(-0.01, 0.01);
  const double bias = random.Uniform(-0.3, 0.3) * std::numbers::pi / 180;
  std::vector<WheelReading> readings;
  const std::size_t n = drive.times.size();
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t a = i > 0 ? i - 1 : 0, b = std::min(i + 1, n - 1);
    const double span = std::max(1e-6, drive.times[b] - drive.times[a]);
    const SE3 motion = drive.world_from_car[a].Inverse() * drive.world_from_car[b];
    const double speed = motion.translation().x() / span;
    const double turn = std::atan2(motion.rotation()(1, 0), motion.rotation()(0, 0)) / span;
    const double steering = std::abs(speed) > 0.3 ? std::atan(kWheelbase * turn / speed) : 0;
    readings.push_back(
        {drive.times[i], speed * scale + 0.05 * random.Normal(),
         std::clamp(steering, -0.6, 0.6) + bias + 0.2 * std::numbers::pi / 180 * random.Normal()});
  }
  return readings;
}

}  // namespace recollect::simulation
