#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "recollect/core/random.h"
#include "recollect/simulation/site.h"

namespace recollect::simulation {
namespace {

using Eigen::Vector3d;

constexpr double kLane = 3.3;        // width of a lane, metres
constexpr double kRoomBeside = 1.5;  // from a drive's line to the kerb: half a car and some

// Points found by place, in cells of 8 m.
class PointIndex {
 public:
  void Add(const Vector3d& p, std::size_t id) { cells_[Key(p.x(), p.y())].push_back({p, id}); }
  // The nearest point within 8 m among those whose id passes; -1 when there is none.
  template <typename Pass>
  std::ptrdiff_t Nearest(const Vector3d& p, const Pass& pass) const {
    std::ptrdiff_t best = -1;
    double best_distance = 8;
    for (int i = -1; i <= 1; ++i) {
      for (int j = -1; j <= 1; ++j) {
        const auto cell = cells_.find(Key(p.x() + 8 * i, p.y() + 8 * j));
        if (cell == cells_.end()) continue;
        for (const auto& [q, id] : cell->second) {
          const double d = std::hypot(q.x() - p.x(), q.y() - p.y());
          if (best_distance > d && pass(id)) {
            best_distance = d;
            best = static_cast<std::ptrdiff_t>(id);
          }
        }
      }
    }
    return best;
  }

 private:
  static std::int64_t Key(double x, double y) {
    return static_cast<std::int64_t>(std::floor(x / 8)) * 1000003 +
           static_cast<std::int64_t>(std::floor(y / 8));
  }
  std::unordered_map<std::int64_t, std::vector<std::pair<Vector3d, std::size_t>>> cells_;
};

std::vector<Vector3d> Smooth(const std::vector<Vector3d>& line, bool closed, int radius) {
  const auto n = static_cast<std::ptrdiff_t>(line.size());
  std::vector<Vector3d> out(line.size());
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    // A window that shrinks towards open ends keeps them where they are.
    const std::ptrdiff_t r = closed ? radius : std::min<std::ptrdiff_t>({radius, i, n - 1 - i});
    Vector3d sum = Vector3d::Zero();
    for (std::ptrdiff_t k = -r; k <= r; ++k) sum += line[static_cast<std::size_t>((i + k + n) % n)];
    out[static_cast<std::size_t>(i)] = sum / static_cast<double>(2 * r + 1);
  }
  return out;
}

void Extend(std::vector<Vector3d>& line, double beyond) {
  const std::size_t n = line.size(), back = std::min<std::size_t>(8, n - 1);
  const Vector3d out = (line[n - 1] - line[n - 1 - back]).normalized();
  const Vector3d in = (line[0] - line[back]).normalized();
  std::vector<Vector3d> longer;
  for (double s = beyond; s >= 1; s -= 1)
    longer.push_back(line[0] + Vector3d(in.x(), in.y(), 0) * s);
  longer.insert(longer.end(), line.begin(), line.end());
  for (double s = 1; s <= beyond; s += 1) {
    longer.push_back(line[n - 1] + Vector3d(out.x(), out.y(), 0) * s);
  }
  line = std::move(longer);
}

// The pieces of a line that run where nothing ran before; `index` learns the line's points.
std::vector<std::vector<Vector3d>> NewPieces(const std::vector<Vector3d>& line, PointIndex& index,
                                             std::size_t& ids) {
  std::vector<std::vector<Vector3d>> pieces(1);
  const std::size_t first = ids;
  for (const Vector3d& p : line) {
    const std::size_t own = ids++;
    const auto other = index.Nearest(p, [&](std::size_t id) {
      return id < first || own - id > 40;  // the line's own last metres are no other street
    });
    if (other >= 0) {
      if (!pieces.back().empty()) pieces.emplace_back();
    } else {
      pieces.back().push_back(p);
    }
    index.Add(p, own);
  }
  std::erase_if(pieces, [](const auto& piece) { return piece.size() < 15; });
  return pieces;
}

Street MakeStreet(std::vector<Vector3d> line, double beyond) {
  Street street;
  const Vector3d gap = line.back() - line.front();
  street.closed = line.size() > 60 && gap.head<2>().norm() < 12;
  if (street.closed) {
    std::vector<Vector3d> closing = {line.back(), line.front()};
    const auto bridge = Resample(closing, 1);
    if (bridge.size() > 1) line.insert(line.end(), bridge.begin() + 1, bridge.end());
  } else if (beyond > 0) {
    Extend(line, beyond);
  }
  line = Smooth(Smooth(line, street.closed, 4), street.closed, 4);
  const auto n = static_cast<std::ptrdiff_t>(line.size());
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    const auto at = [&](std::ptrdiff_t k) {
      return line[static_cast<std::size_t>(
          street.closed ? (k + n) % n : std::clamp<std::ptrdiff_t>(k, 0, n - 1))];
    };
    const Eigen::Vector2d ahead = (at(i + 2) - at(i - 2)).head<2>().normalized();
    const Eigen::Vector2d left(-ahead.y(), ahead.x());
    Street::Station station;
    const Vector3d& p = at(i);
    station.middle =
        Vec3(static_cast<float>(p.x() + left.x() * kLane / 2),
             static_cast<float>(p.y() + left.y() * kLane / 2), static_cast<float>(p.z()));
    station.left = left.cast<float>();
    station.half_left = station.half_right = static_cast<float>(kLane);
    street.stations.push_back(station);
  }
  return street;
}

// Widens a street so that no drive comes nearer to its kerb than kRoomBeside.
void Widen(Street& street, const Route& route) {
  PointIndex index;
  for (std::size_t i = 0; i < street.stations.size(); ++i) {
    index.Add(street.stations[i].middle.cast<double>(), i);
  }
  for (const Drive& drive : route.drives) {
    for (const SE3& pose : drive.world_from_car) {
      const auto nearest = index.Nearest(pose.translation(), [](std::size_t) { return true; });
      if (nearest < 0) continue;
      Street::Station& s = street.stations[static_cast<std::size_t>(nearest)];
      const Vec2 off = pose.translation().head<2>().cast<float>() - s.middle.head<2>();
      const float side = off.dot(s.left), room = static_cast<float>(kRoomBeside);
      s.half_left = std::max(s.half_left, side + room);
      s.half_right = std::max(s.half_right, room - side);
    }
  }
  // A bulge begins and ends gently: no kerb turns by more than 1 in 6.
  const std::size_t n = street.stations.size();
  for (int round = 0; round < 2; ++round) {
    for (std::size_t i = 1; i < n; ++i) {
      const auto ease = [](float& here, float there) { here = std::max(here, there - 1.0F / 6); };
      ease(street.stations[i].half_left, street.stations[i - 1].half_left);
      ease(street.stations[i].half_right, street.stations[i - 1].half_right);
      ease(street.stations[n - 1 - i].half_left, street.stations[n - i].half_left);
      ease(street.stations[n - 1 - i].half_right, street.stations[n - i].half_right);
    }
  }
}

// Parking bays along some stretches of either side.
void AddBays(Street& street, std::uint64_t seed) {
  Random random(seed);
  const auto n = street.stations.size();
  for (const bool left : {false, true}) {
    auto i = static_cast<std::size_t>(random.Uniform(5, 60));
    while (i < n) {
      const auto end = std::min(n, i + static_cast<std::size_t>(random.Uniform(14, 50)));
      for (; i < end; ++i)
        (left ? street.stations[i].bay_left : street.stations[i].bay_right) = 2.3F;
      i += static_cast<std::size_t>(random.Uniform(25, 110));
    }
  }
}

}  // namespace

Vec3 PointOn(const Street& street, float s, float side) {
  const auto n = static_cast<std::ptrdiff_t>(street.stations.size());
  const float whole = std::floor(s), part = s - whole;
  const auto at = [&](std::ptrdiff_t i) -> const Street::Station& {
    const std::ptrdiff_t k =
        street.closed ? ((i % n) + n) % n : std::clamp<std::ptrdiff_t>(i, 0, n - 1);
    return street.stations[static_cast<std::size_t>(k)];
  };
  const auto& a = at(static_cast<std::ptrdiff_t>(whole));
  const auto& b = at(static_cast<std::ptrdiff_t>(whole) + 1);
  const Vec2 left = a.left * (1 - part) + b.left * part;
  Vec3 p = a.middle * (1 - part) + b.middle * part;
  p.head<2>() += left * side;
  return p;
}

std::vector<Street> LayStreets(const Route& route, std::uint64_t seed, float beyond) {
  PointIndex index;
  std::size_t ids = 0;
  std::vector<Street> streets;
  const auto add = [&](const std::vector<Vector3d>& line, double extension) {
    for (auto& piece : NewPieces(line, index, ids)) {
      streets.push_back(MakeStreet(std::move(piece), extension));
      Widen(streets.back(), route);
      AddBays(streets.back(), SubSeed(seed, streets.size()));
    }
  };
  add(route.way, beyond);
  for (const Drive& drive : route.drives) {
    std::vector<Vector3d> line;
    for (const SE3& pose : drive.world_from_car) {
      if (line.empty() || (pose.translation() - line.back()).norm() > 0.5) {
        line.push_back(pose.translation());
      }
    }
    add(Resample(line, 1), 0);
  }
  return streets;
}

}  // namespace recollect::simulation
