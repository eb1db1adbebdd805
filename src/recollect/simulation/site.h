#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "recollect/simulation/mesh.h"
#include "recollect/simulation/route.h"

namespace recollect::simulation {

// A stretch of road between two ends, or a closed one. One station a metre along its middle.
struct Street {
  struct Station {
    Vec3 middle = Vec3::Zero();
    Vec2 left = Vec2::UnitY();            // unit vector across, to the left of the way
    float half_left = 0, half_right = 0;  // width of the carriageway to either side, metres
    float bay_left = 0, bay_right = 0;    // width of parking bays beyond it, 0: none
    float edge_left() const { return half_left + bay_left; }
    float edge_right() const { return half_right + bay_right; }
  };
  std::vector<Station> stations;
  bool closed = false;

  float length() const { return static_cast<float>(stations.size()); }
  // Heading at a station, radians from world x towards y.
  float Heading(std::size_t i) const {
    return std::atan2(-stations[i].left.x(), stations[i].left.y());
  }
};

// The roads that a route needs: its way is the right lane of a road of two lanes, wider where a
// recorded drive needs it; parts of recorded drives that leave the way get streets of their own.
// Ends that do not meet go on for `beyond` metres.
// Parking bays line some stretches, as `seed` has it.
std::vector<Street> LayStreets(const Route& route, std::uint64_t seed, float beyond = 80);

// The point `side` metres to the left (right: negative) of the middle, `s` metres along the way;
// its height is the middle's. On closed streets s wraps.
Vec3 PointOn(const Street& street, float s, float side);

// The lie of the land and who has a claim on it, on a grid of half a metre.
class Site {
 public:
  Site(const Route& route, const std::vector<Street>& streets, std::uint64_t seed);

  // The same land with claims of its own (matrices share their data when merely assigned).
  Site Copy() const;

  // Height of the ground, which the road lies on; hills rise away from it.
  float Height(float x, float y) const;
  // Distance to the nearest carriageway or track of a drive (with room for the car), 0 on it.
  float Clearance(float x, float y) const;
  Vec3 OnGround(float x, float y, float lift = 0) const { return {x, y, Height(x, y) + lift}; }
  Vec3 OnGround(const Vec3& p, float lift = 0) const { return OnGround(p.x(), p.y(), lift); }

  // Whether a convex polygon touches neither carriageways nor ground that is taken.
  bool IsFree(const std::vector<Vec2>& outline) const;
  void Take(const std::vector<Vec2>& outline);
  // Both in one: takes the ground where it is free.
  bool Claim(const std::vector<Vec2>& outline);

  Vec2 low() const { return low_; }
  Vec2 high() const { return high_; }

 private:
  std::vector<cv::Point> Cells(const std::vector<Vec2>& outline) const;

  Vec2 low_, high_;
  cv::Mat1f clearance_;  // half-metre cells
  cv::Mat1f height_;     // four-metre cells
  cv::Mat1b taken_;
};

// Corners of a rectangle, counter-clockwise: `along` and `across` are its whole sides, along the
// heading and to the left of it.
std::vector<Vec2> Rectangle(const Vec2& centre, float heading, float along, float across);

}  // namespace recollect::simulation
