#include "recollect/simulation/route.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "recollect/core/error.h"
#include "recollect/core/random.h"
#include "recollect/dataset/reader.h"
#include "recollect/simulation/day.h"

namespace recollect::simulation {
namespace {

using Eigen::Vector3d;

// A smooth random function of the distance driven: three waves, about 1 in standard deviation.
class Sway {
 public:
  Sway(Random& random, double shortest, double longest) {
    for (Wave& w : waves_) {
      w.rate = 2 * std::numbers::pi / random.Uniform(shortest, longest);
      w.phase = random.Uniform(0, 2 * std::numbers::pi);
    }
  }
  double operator()(double s) const {
    double sum = 0;
    for (const Wave& w : waves_) sum += std::sin(w.rate * s + w.phase);
    return sum * 0.816;
  }

 private:
  struct Wave {
    double rate, phase;
  };
  std::array<Wave, 3> waves_;
};

SE3 CarPose(const Vector3d& at, double yaw, double pitch, double roll) {
  const Eigen::Matrix3d R =
      (Eigen::AngleAxisd(yaw, Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Vector3d::UnitY()) *
       Eigen::AngleAxisd(roll, Vector3d::UnitX()))
          .toRotationMatrix();
  return {R, at};
}

// A day in the years of the recordings: each lap some months after the last, at another hour.
double MadeUpStart(int lap, std::uint64_t seed) {
  Random random(SubSeed(seed, static_cast<std::uint64_t>(lap)));
  const double first = UnixTime(2016, 8, 25, 0, 0);
  const double day = std::floor(first / 86400 + 52.0 * (lap - 1) + random.Uniform(0, 40));
  const double local_hour = random.Uniform(8.3, 16.3);
  return (day * 24 + local_hour + 3) * 3600;  // local time is three hours behind UTC
}

void RequireWay(const std::string& where, const std::vector<Vector3d>& way) {
  for (std::size_t i = 1; i < way.size(); ++i) {
    const Vector3d step = way[i] - way[i - 1];
    Require(
        std::abs(step.z()) <= 0.3 * step.norm(), where,
        fmt::format("the route is steeper than 30 % near ({:.1f}, {:.1f})", way[i].x(), way[i].y()),
        "z must be up");
  }
  for (std::size_t i = 0; i < way.size(); i += 2) {
    for (std::size_t j = i + 40; j < way.size(); j += 2) {
      const Vector3d gap = way[i] - way[j];
      Require(gap.head<2>().norm() > 8 || std::abs(gap.z()) < 2, where,
              fmt::format("the route crosses itself at different heights near ({:.1f}, {:.1f})",
                          way[i].x(), way[i].y()),
              "bridges are not supported");
    }
  }
}

}  // namespace

std::vector<Vector3d> Resample(const std::vector<Vector3d>& line, double step) {
  std::vector<Vector3d> points;
  double ahead = 0;  // distance from the start of this piece to the next point
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vector3d way = line[i + 1] - line[i];
    const double length = way.norm();
    for (; ahead < length; ahead += step) points.push_back(line[i] + way * (ahead / length));
    ahead -= length;
  }
  return points;
}

Route RingRoute(std::uint64_t seed) {
  Random random(SubSeed(seed, 0x21));
  const double a = random.Uniform(0.10, 0.17), b = random.Uniform(0.03, 0.07);
  const double p = random.Uniform(0, 6.28), q = random.Uniform(0, 6.28),
               h = random.Uniform(0, 6.28);
  std::vector<Vector3d> ring;
  double length = 0;
  for (int i = 0; i <= 2000; ++i) {
    const double t = 2 * std::numbers::pi * i / 2000;
    const double r = 1 + a * std::cos(2 * t + p) + b * std::cos(3 * t + q);
    ring.emplace_back(r * std::cos(t), r * std::sin(t), 0);
    if (i > 0) length += (ring[ring.size() - 1] - ring[ring.size() - 2]).norm();
  }
  const double scale = 400 / length;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    ring[i] *= scale;
    ring[i].z() = 0.9 * std::sin(2 * 2 * std::numbers::pi * static_cast<double>(i) / 2000 + h);
  }
  Route route;
  route.name = "ring";
  route.way = Resample(ring, 1);
  return route;
}

Route TumRoute(const std::filesystem::path& file) {
  Route route;
  route.name = file.filename().string();
  const std::vector<Lap> laps = ReadLaps(file, Format::kTum);
  std::vector<Vector3d> line;
  for (const Frame& frame : laps.front().frames) {
    const Vector3d& at = frame.world_from_body.translation();
    if (!line.empty()) {
      const double step = (at - line.back()).norm();
      Require(step < 20, file.string(),
              fmt::format("the route jumps by {:.1f} m at time {:.3f}", step, frame.time));
      if (step < 0.3) continue;
    }
    line.push_back(at);
  }
  Require(line.size() > 1, file.string(), "a route needs at least 20 m of way, this has one place");
  const Vector3d origin = line.front();
  for (Vector3d& p : line) p -= origin;
  route.way = Resample(line, 1);
  Require(route.way.size() >= 20, file.string(),
          fmt::format("a route needs at least 20 m of way, this has {}", route.way.size()));
  RequireWay(file.string(), route.way);
  return route;
}

Route UfesRoute(const std::filesystem::path& folder) {
  Route route;
  route.name = "ufes";
  const std::vector<Lap> laps = ReadLaps(folder, Format::kUfes);
  const Vector3d origin(route.origin_utm.x(), -route.origin_utm.y(), 0);
  for (const Lap& lap : laps) {
    Drive drive;
    for (const Frame& frame : lap.frames) {
      drive.times.push_back(frame.time);
      drive.world_from_car.emplace_back(frame.world_from_body.rotation(),
                                        frame.world_from_body.translation() - origin);
    }
    const bool registration = drive.times.front() < UnixTime(2015, 1, 1, 0, 0);
    if (registration) {
      for (const SE3& pose : drive.world_from_car) route.registration.push_back(pose.translation());
    } else {
      drive.number = static_cast<int>(route.drives.size()) + 1;
      route.drives.push_back(std::move(drive));
    }
  }
  Require(!route.drives.empty(), folder.string(), "no recorded drives here",
          "point it at the folder with the camerapos-*.txt files");
  std::vector<Vector3d> line;
  for (const SE3& pose : route.drives.front().world_from_car) {
    const Vector3d& at = pose.translation();
    if (line.empty() || (at - line.back()).norm() > 0.5) line.push_back(at);
  }
  route.way = Resample(line, 1);
  Require(route.way.size() >= 20, folder.string(), "a route needs at least 20 m of way");
  return route;
}

Drive Route::DriveOf(int lap, std::uint64_t seed) const {
  if (!drives.empty()) {
    Require(lap >= 1 && lap <= static_cast<int>(drives.size()), "laps",
            fmt::format("there is no lap {}: this route has laps 1 to {}", lap, drives.size()));
    return drives[static_cast<std::size_t>(lap - 1)];
  }
  Require(lap >= 1 && lap <= 99, "laps",
          fmt::format("there is no lap {}: laps go from 1 to 99", lap));
  Random random(SubSeed(SubSeed(seed, 0x1a9), static_cast<std::uint64_t>(lap)));
  const double bias = random.Uniform(-0.3, 0.3);
  const Sway lateral(random, 40, 160), nod(random, 12, 60), lean(random, 12, 60),
      haste(random, 60, 200);
  Drive drive;
  drive.number = lap;
  double time = MadeUpStart(lap, seed);
  constexpr double kStep = 0.4;
  const std::vector<Vector3d> line = Resample(way, kStep);
  for (std::size_t i = 0; i < line.size(); ++i) {
    const double s = kStep * static_cast<double>(i);
    const Vector3d ahead = line[std::min(i + 3, line.size() - 1)] - line[i < 3 ? 0 : i - 3];
    const double along = std::atan2(ahead.y(), ahead.x());
    const double climb = std::atan2(ahead.z(), ahead.head<2>().norm());
    const double side = std::clamp(bias + 0.22 * lateral(s), -kLargestSway, kLargestSway);
    const double turn = (0.22 * lateral(s + 0.5) - 0.22 * lateral(s - 0.5));
    drive.times.push_back(time);
    drive.world_from_car.push_back(
        CarPose(line[i] + side * Vector3d(-std::sin(along), std::cos(along), 0), along + turn,
                -climb + 0.008 * nod(s), 0.008 * lean(s)));
    time += kStep / (6.0 + 1.2 * haste(s));
  }
  return drive;
}

StereoCamera UfesCamera() {
  return {{.width = 640, .height = 480, .fx = 489.44, .fy = 489.44, .cx = 323.5, .cy = 237.0},
          0.24004};
}

SE3 UfesCarFromCamera() {
  Eigen::Matrix3d axes;  // camera x right, y down, z forward in the car's x forward, y left, z up
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const SE3 mount = CarPose({0.817, -0.04, 1.88}, -0.0236, 0.026, -0.0175);
  return mount * SE3(axes, Vector3d::Zero());
}

}  // namespace recollect::simulation
