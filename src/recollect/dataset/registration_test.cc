#include "recollect/dataset/registration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "recollect/core/error.h"
#include "recollect/geometry/frames.h"

namespace recollect {
namespace {

// `rounds` anti-clockwise rounds of a circle of 100 m about the origin, a frame every `step`
// metres, beginning `phase` metres along.
Lap Circle(double rounds, double step, double phase = 0,
           double radius = 100 / std::numbers::pi / 2) {
  Lap lap;
  lap.name = "circle";
  lap.body_forward = Eigen::Vector3d::UnitX();
  lap.world_up = Eigen::Vector3d::UnitZ();
  for (double s = 0; s < rounds * 100; s += step) {
    const double angle = 2 * std::numbers::pi * (s + phase) / 100;
    lap.frames.emplace_back().world_from_body =
        SE3(RotationFromRollPitchYaw(0, 0, angle + std::numbers::pi / 2),
            {radius * std::cos(angle), radius * std::sin(angle), 0});
  }
  return lap;
}

TEST(LoopEnd, IsWhereTheDriveComesBackLast) {
  // Frame 199 is 0.5 m short of the first; then the distance grows again.
  EXPECT_EQ(LoopEnd(Circle(1.5, 0.5), 1), 200u);
  EXPECT_EQ(LoopEnd(Circle(2.5, 0.5), 1), 400u);
  EXPECT_EQ(LoopEnd(Circle(0.5, 0.5), 1), 99u);  // never back: all but the last
  EXPECT_EQ(LoopEnd(Lap{}, 1), 0u);
}

TEST(RegisterPlaces, LabelsTheTestAndOneTrainingFrameAPass) {
  const Lap reference = Circle(1.2, 0.5), test = Circle(1.2, 0.25), train = Circle(2.2, 0.25);
  const Registration registration = RegisterPlaces(reference, test, {&train, &test});
  // A chord of 5 m is a little shorter than its arc, so that a place comes every 5.5 m of road.
  const std::size_t places = registration.places.size();
  EXPECT_EQ(places, 19u);
  ASSERT_EQ(registration.train.size(), 2u);
  // Two rounds less the pass that is left open, and one round less that.
  EXPECT_NEAR(static_cast<double>(registration.train[0].frames.size()),
              static_cast<double>(2 * places), 2);
  EXPECT_NEAR(static_cast<double>(registration.train[1].frames.size()), static_cast<double>(places),
              2);
  const auto distance = [&](const Lap& lap, const PlacedFrames& placed, std::size_t i) {
    return (lap.frames[placed.frames[i]].world_from_body.translation() -
            reference.frames[registration.places[placed.places[i]]].world_from_body.translation())
        .norm();
  };
  for (std::size_t i = 0; i < registration.test.frames.size(); ++i) {
    EXPECT_LT(distance(test, registration.test, i), 3.3) << i;
  }
  for (std::size_t i = 0; i < registration.train[0].frames.size(); ++i) {
    EXPECT_LT(distance(train, registration.train[0], i), 1.5) << i;
  }
}

TEST(RegisterPlaces, RefusesALapElsewhere) {
  const Lap reference = Circle(1, 0.5), elsewhere = Circle(1, 0.5, 0, 100);
  EXPECT_THROW(RegisterPlaces(reference, elsewhere, {}), Error);
}

}  // namespace
}  // namespace recollect
