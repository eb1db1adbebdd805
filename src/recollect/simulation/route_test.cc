#include "recollect/simulation/route.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "recollect/core/error.h"
#include "recollect/simulation/site.h"
#include "recollect/testing/scratch_folder.h"

namespace recollect::simulation {
namespace {

Route TumRouteOf(const std::string& text) {
  const testing::ScratchFolder folder;
  std::ofstream(folder / "route.tum") << text;
  return TumRoute(folder / "route.tum");
}

std::string Line(const std::vector<Eigen::Vector3d>& points) {
  std::string text;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& p = points[i];
    text += fmt::format("{} {} {} {} 0 0 0 1\n", i, p.x(), p.y(), p.z());
  }
  return text;
}

TEST(Ring, IsClosedAndAboutFourHundredMetres) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Route ring = RingRoute(seed);
    EXPECT_NEAR(static_cast<double>(ring.way.size()), 400, 2);
    EXPECT_LT((ring.way.front() - ring.way.back()).norm(), 2);
    const std::vector<Street> streets = LayStreets(ring, seed);
    ASSERT_EQ(streets.size(), 1U);
    EXPECT_TRUE(streets.front().closed);
  }
}

TEST(Ring, DrivesKeepToTheirLane) {
  const Route ring = RingRoute(1);
  for (int lap = 1; lap <= 5; ++lap) {
    const Drive drive = ring.DriveOf(lap, 1);
    for (std::size_t i = 1; i < drive.times.size(); ++i) {
      EXPECT_GT(drive.times[i], drive.times[i - 1]);
      double nearest = 1e9;
      for (const auto& p : ring.way) {
        nearest = std::min(nearest, (p - drive.world_from_car[i].translation()).head<2>().norm());
      }
      ASSERT_LT(nearest, kLargestSway + 0.6);
    }
  }
  EXPECT_THROW(ring.DriveOf(0, 1), Error);
  EXPECT_THROW(ring.DriveOf(100, 1), Error);
}

TEST(TumRoute, MayCrossItselfAndEndAbruptly) {
  std::vector<Eigen::Vector3d> eight;
  for (int i = 0; i <= 200; ++i) {
    const double t = 2 * M_PI * i / 200 * 0.97;
    eight.emplace_back(80 * std::sin(t), 50 * std::sin(2 * t), 0.5 * std::sin(2 * t));
  }
  const Route route = TumRouteOf(Line(eight));
  const std::vector<Street> streets = LayStreets(route, 1);
  EXPECT_GE(streets.size(), 2U);  // it is cut where it meets itself
  const Site site(route, streets, 1);
  const Drive drive = route.DriveOf(1, 1);
  for (const SE3& pose : drive.world_from_car) {
    const Eigen::Vector3d& p = pose.translation();
    ASSERT_LT(site.Clearance(static_cast<float>(p.x()), static_cast<float>(p.y())), 0.1F);
  }
}

TEST(TumRoute, RefusesWhatIsNoRoute) {
  const auto refuses = [](const std::string& name, const std::string& text,
                          const std::string& why) {
    try {
      TumRouteOf(text);
      ADD_FAILURE() << name << " was taken";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  };
  refuses("one", Line({{0, 0, 0}}), "20 m");
  refuses("still", Line({{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}}), "20 m");
  refuses("short", Line({{0, 0, 0}, {5, 0, 0}, {10, 0, 0}}), "20 m");
  refuses("nan", "0 0 0 0 0 0 0 1\n1 nan 0 0 0 0 0 1\n", "2");
  refuses("jump", Line({{0, 0, 0}, {10, 0, 0}, {90, 0, 0}}), "jumps");
  refuses("steep", Line({{0, 0, 0}, {10, 0, 0}, {20, 0, 8}, {30, 0, 16}}), "steeper");
  std::vector<Eigen::Vector3d> bridge;
  for (int i = 0; i <= 300; ++i) {
    const double t = 2 * M_PI * i / 300;
    bridge.emplace_back(80 * std::sin(t), 50 * std::sin(2 * t), 4 * std::cos(t));
  }
  refuses("bridge", Line(bridge), "different heights");
  EXPECT_THROW(TumRoute("/nowhere/at-all.tum"), Error);
}

TEST(Ufes, ReadsAllDrives) {
  const std::filesystem::path data = std::filesystem::path(RECOLLECT_SHARED_DATA) / "ufes-laps";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "no " << data;
  const Route route = UfesRoute(data);
  EXPECT_EQ(route.drives.size(), 10U);
  EXPECT_FALSE(route.registration.empty());
  const std::vector<Street> streets = LayStreets(route, 1);
  const Site site(route, streets, 1);
  for (const Drive& drive : route.drives) {
    for (const SE3& pose : drive.world_from_car) {
      const Eigen::Vector3d& p = pose.translation();
      ASSERT_LT(site.Clearance(static_cast<float>(p.x()), static_cast<float>(p.y())), 0.1F);
    }
  }
}

}  // namespace
}  // namespace recollect::simulation
