#include "recollect/simulation/traffic.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace recollect::simulation {
namespace {

constexpr double kSight = 130;      // metres; farther movers are left out
constexpr double kOtherLane = 3.4;  // from our line to that of oncoming cars
constexpr double kBonnet = 3.9;     // from the car's origin to its front, with some room

int Pick(Random& random, const std::vector<int>& models) {
  return models[static_cast<std::size_t>(random.Index(static_cast<std::int64_t>(models.size())))];
}

}  // namespace

Traffic::Traffic(const Campus& campus, const Vehicles& vehicles, const Day& day, const Drive& drive)
    : campus_(campus), vehicles_(vehicles), drive_(drive) {
  distances_.push_back(0);
  for (std::size_t i = 1; i < drive.world_from_car.size(); ++i) {
    const Eigen::Vector3d step =
        drive.world_from_car[i].translation() - drive.world_from_car[i - 1].translation();
    distances_.push_back(distances_.back() + step.norm());
  }
  const double busy = day.change.traffic ? std::min(day.change.strength, 3.0) : 0;
  if (busy <= 0) return;
  const double length = distances_.back();
  Random random(SubSeed(day.seed, 0x77));
  for (double s = random.Uniform(0, 150); s < length; s += random.Uniform(60, 420) / busy) {
    Ahead a;
    a.from = s;
    a.to = s + random.Uniform(30, 160);
    const bool large = random.Uniform() < 0.3, close = random.Uniform() < 0.4;
    a.gap = close ? random.Uniform(1.2, 4) : random.Uniform(6, 28);
    a.sway = random.Uniform(0.1, 0.3) * a.gap;
    a.model = Pick(random, large ? vehicles.lorries : vehicles.cars);
    a.paint = DrawCarPaint(random);
    ahead_.push_back(a);
    s = a.to;
  }
  for (double s = random.Uniform(0, 80); s < length; s += random.Uniform(15, 220) / busy) {
    const int model = Pick(random, random.Uniform() < 0.15 ? vehicles.lorries : vehicles.cars);
    oncoming_.push_back({s, TimeAt(s), random.Uniform(5, 10), model, DrawCarPaint(random)});
  }
  for (std::size_t k = 0; k < campus.streets.size(); ++k) {
    const Street& street = campus.streets[k];
    for (double s = random.Uniform(0, 40); s < street.length(); s += random.Uniform(4, 70) / busy) {
      const auto& station = street.stations[static_cast<std::size_t>(s)];
      const bool left = random.Uniform() < 0.5;
      const float off = Draw(random, 0.7, 2.2);
      walkers_.push_back(
          {k, static_cast<float>(s), left ? station.edge_left() + off : -station.edge_right() - off,
           Draw(random, 0.8, 1.5), Draw(random, 0, 6.28), Pick(random, vehicles.people)});
    }
  }
}

double Traffic::Distance(double time) const {
  const auto& t = drive_.times;
  const auto i = static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(std::upper_bound(t.begin(), t.end(), time) - t.begin(), 1,
                                 static_cast<std::ptrdiff_t>(t.size()) - 1));
  const double share = std::clamp((time - t[i - 1]) / (t[i] - t[i - 1]), 0.0, 1.0);
  return distances_[i - 1] + share * (distances_[i] - distances_[i - 1]);
}

double Traffic::TimeAt(double distance) const {
  const auto i =
      std::lower_bound(distances_.begin(), distances_.end(), distance) - distances_.begin();
  return drive_.times[static_cast<std::size_t>(
      std::min<std::ptrdiff_t>(i, static_cast<std::ptrdiff_t>(drive_.times.size()) - 1))];
}

Instance Traffic::OnDrive(double distance, double side, bool backwards, int model,
                          const Color& paint) const {
  const auto n = static_cast<std::ptrdiff_t>(distances_.size());
  const auto i = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(
      std::upper_bound(distances_.begin(), distances_.end(), distance) - distances_.begin(), 1,
      n - 1));
  const double step = distances_[i] - distances_[i - 1];
  const double share = step > 0 ? std::clamp((distance - distances_[i - 1]) / step, 0.0, 1.0) : 0;
  const SE3 pose = Interpolate(drive_.world_from_car[i - 1], drive_.world_from_car[i], share);
  const Eigen::Vector3d forward = pose.rotation().col(0);
  const double yaw = std::atan2(forward.y(), forward.x());
  const auto x = static_cast<float>(pose.translation().x() - side * std::sin(yaw));
  const auto y = static_cast<float>(pose.translation().y() + side * std::cos(yaw));
  const auto heading = static_cast<float>(yaw + (backwards ? std::numbers::pi : 0));
  return {model, Eigen::Affine3f(Standing(campus_.site.OnGround(x, y), heading)), paint};
}

std::vector<Instance> Traffic::At(double time) const {
  std::vector<Instance> movers;
  const double here = Distance(time), length = distances_.back();
  for (const Ahead& a : ahead_) {
    if (here < a.from || here > a.to) continue;
    const double size = static_cast<double>(vehicles_.lengths[static_cast<std::size_t>(a.model)]);
    const double there =
        here + kBonnet + a.gap + a.sway * std::sin(time * 0.35 + a.from) + size / 2;
    if (there + size / 2 < length) movers.push_back(OnDrive(there, 0, false, a.model, a.paint));
  }
  for (const Oncoming& o : oncoming_) {
    const double there = o.meets_at - o.speed * (time - o.meets_when);
    if (std::abs(there - here) > kSight || there < 2 || there > length - 2) continue;
    movers.push_back(OnDrive(there, kOtherLane, true, o.model, o.paint));
  }
  const Vec3 car = OnDrive(here, 0, false, 0, Color::Ones()).world_from_model.translation();
  for (const Walker& w : walkers_) {
    const Street& street = campus_.streets[w.street];
    const float swing = static_cast<float>(time) * w.pace / 12 + w.phase;
    const float s = std::clamp(w.s + 12 * std::sin(swing), 0.0F, street.length() - 1);
    Vec3 at = PointOn(street, s, w.side);
    if ((at - car).head<2>().norm() > 70 || campus_.site.Clearance(at.x(), at.y()) < 0.3F) continue;
    at = campus_.site.OnGround(at, 0.14F);
    const float heading = street.Heading(static_cast<std::size_t>(s)) +
                          (std::cos(swing) > 0 ? 0 : std::numbers::pi_v<float>);
    movers.push_back({w.model, Eigen::Affine3f(Standing(at, heading)), Color::Ones()});
  }
  return movers;
}

}  // namespace recollect::simulation
