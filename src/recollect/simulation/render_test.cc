// Does a rendered lap hold together: poses, depth, stereo, and the same bits every time?
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "recollect/simulation/lap_renderer.h"

namespace recollect::simulation {
namespace {

// A lap of the ring with everything a test may want to vary.
struct Setting {
  explicit Setting(int lap = 1, const Change& change = {}, Weather weather = Weather::kFair)
      : pictures(Pictures()),
        route(RingRoute(1)),
        campus(route, 1),
        drive(route.DriveOf(lap, 1)),
        day(MakeDay(drive.times.front(), change, weather, 1)),
        options(Options()),
        renderer(campus, pictures, drive, day, options) {}

  static SimulateOptions Options() {
    SimulateOptions options;
    options.stereo = options.depth = true;
    options.depth_step = 1;
    return options;
  }

  static const PictureSet& Pictures() {
    static ThreadPool pool(2);
    static const PictureSet pictures(pool);
    return pictures;
  }

  const PictureSet& pictures;
  Route route;
  Campus campus;
  Drive drive;
  Day day;
  SimulateOptions options;
  LapRenderer renderer;
};

Change Still() {
  Change change;
  change.traffic = false;
  return change;
}

double DepthAt(const cv::Mat& depth, int x, int y) { return depth.at<std::uint16_t>(y, x) / 100.0; }

// Mean gray difference between a picture and another into which its points are carried by depth
// and pose; where the other shows the same surface, as its own depth says.
double Mismatch(const LapRenderer::Shot& a, const cv::Mat& other, const cv::Mat& other_depth,
                const PinholeCamera& camera, const SE3& other_from_a) {
  cv::Mat1b ga, gb;
  cv::cvtColor(a.left, ga, cv::COLOR_BGR2GRAY);
  cv::cvtColor(other, gb, cv::COLOR_BGR2GRAY);
  double sum = 0;
  int count = 0;
  for (int y = 10; y < ga.rows - 10; y += 2) {
    for (int x = 10; x < ga.cols - 10; x += 2) {
      const double depth = DepthAt(a.depth, x, y);
      if (depth <= 0 || depth > 30) continue;
      const Eigen::Vector3d q = other_from_a * camera.Unproject(x, y, depth);
      const Eigen::Vector2d p = camera.Project(q);
      const int px = static_cast<int>(std::floor(p.x())), py = static_cast<int>(std::floor(p.y()));
      if (px < 0 || py < 0 || px + 1 >= gb.cols || py + 1 >= gb.rows) continue;
      if (!other_depth.empty() && std::abs(DepthAt(other_depth, px, py) - q.z()) > 0.05 * q.z())
        continue;
      const double u = p.x() - px, v = p.y() - py;
      const double g = (gb(py, px) * (1 - u) + gb(py, px + 1) * u) * (1 - v) +
                       (gb(py + 1, px) * (1 - u) + gb(py + 1, px + 1) * u) * v;
      sum += std::abs(g - ga(y, x));
      ++count;
    }
  }
  EXPECT_GT(count, 5000);
  return sum / count;
}

TEST(Render, DepthAndPosesAgree) {
  const Setting s(1, Still());
  const PinholeCamera& camera = s.renderer.camera().left;
  for (const std::size_t i : {100U, 420U, 800U}) {
    const LapRenderer::Shot a = s.renderer.Take(i), b = s.renderer.Take(i + 2);
    const SE3 b_from_a =
        s.renderer.WorldFromCamera(i + 2).Inverse() * s.renderer.WorldFromCamera(i);
    const SE3 right_from_left(Eigen::Matrix3d::Identity(), {-s.renderer.camera().baseline, 0, 0});
    const SE3 shifted(Eigen::Matrix3d::Identity(), {0.2, 0, 0});
    const SE3 turned = SE3::FromRotationVector({0, 0.5 * M_PI / 180, 0}, {0, 0, 0});
    const double next = Mismatch(a, b.left, b.depth, camera, b_from_a);
    const double right = Mismatch(a, a.right, {}, camera, right_from_left);
    for (const SE3& wrong : {shifted, turned}) {
      EXPECT_LT(next, 0.75 * Mismatch(a, b.left, {}, camera, wrong * b_from_a)) << "frame " << i;
      EXPECT_LT(right, 0.75 * Mismatch(a, a.right, {}, camera, wrong * right_from_left))
          << "frame " << i;
    }
  }
}

TEST(Render, StereoMatchingFindsTheTrueDepth) {
  const Setting s(1, Still());
  std::vector<double> errors;
  for (const std::size_t i : {60U, 300U, 700U}) {
    const LapRenderer::Shot shot = s.renderer.Take(i);
    cv::Mat1b left, right;
    cv::cvtColor(shot.left, left, cv::COLOR_BGR2GRAY);
    cv::cvtColor(shot.right, right, cv::COLOR_BGR2GRAY);
    const auto matcher = cv::StereoSGBM::create(0, 96, 5, 200, 800, 1, 15, 10, 60, 2);
    cv::Mat1s disparity;
    matcher->compute(left, right, disparity);
    cv::Mat1f gx;
    cv::Sobel(left, gx, CV_32F, 1, 0);
    for (int y = 5; y < left.rows - 5; ++y) {
      for (int x = 100; x < left.cols - 5; ++x) {
        const double depth = DepthAt(shot.depth, x, y);
        if (depth <= 0 || depth > 25 || disparity(y, x) <= 0 || std::abs(gx(y, x)) < 40) continue;
        const double found = s.renderer.camera().Depth(disparity(y, x) / 16.0);
        errors.push_back(std::abs(found - depth) / depth);
      }
    }
  }
  ASSERT_GT(errors.size(), 20000U);
  std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2),
                   errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.02);
}

TEST(Render, SameSeedAndDayGiveTheSameBits) {
  const Setting one, two;
  std::vector<LapRenderer::Shot> serial, parallel(4);
  for (std::size_t i = 0; i < 4; ++i) serial.push_back(one.renderer.Take(50 + 200 * i));
  ThreadPool pool(4);
  pool.For(4, 1, [&](std::int64_t begin, std::int64_t) {
    const auto i = static_cast<std::size_t>(begin);
    parallel[i] = two.renderer.Take(50 + 200 * i);
  });
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(cv::norm(serial[i].left, parallel[i].left, cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(serial[i].right, parallel[i].right, cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(serial[i].depth, parallel[i].depth, cv::NORM_INF), 0);
  }
}

TEST(Render, DaysDifferInWhatIsSwitchedOn) {
  const Route route = RingRoute(1);
  const Campus campus(route, 1);
  const auto built = [&](int lap, const Change& change) {
    return BuildCampus(campus,
                       MakeDay(route.DriveOf(lap, 1).times.front(), change, Weather::kByDay, 1));
  };
  Change none;
  none.light = none.structures = none.traffic = none.season = false;
  const auto quads = [](const CampusDay& d) { return d.world.solid.quads.size(); };
  const auto tints = [](const CampusDay& d) {
    Color sum = Color::Zero();
    for (const Instance& i : d.world.instances) sum += i.tint;
    return sum.sum();
  };
  const CampusDay a = built(1, none), b = built(7, none);
  EXPECT_EQ(quads(a), quads(b));
  EXPECT_EQ(a.world.instances.size(), b.world.instances.size());
  EXPECT_EQ(tints(a), tints(b));
  Change structures = none;
  structures.structures = true;
  EXPECT_NE(quads(built(1, structures)), quads(built(7, structures)));
  Change traffic = none;
  traffic.traffic = true;
  EXPECT_EQ(quads(built(1, traffic)), quads(built(7, traffic)));
  EXPECT_NE(tints(built(1, traffic)), tints(built(7, traffic)));
  Change season = none;
  season.season = true;
  EXPECT_NE(tints(built(1, season)), tints(built(7, season)));
}

TEST(Render, NothingStandsWhereTheCarDrives) {
  for (const int lap : {1, 2, 5}) {
    const Route route = RingRoute(1);
    const Campus campus(route, 1);
    const PictureSet& pictures = Setting::Pictures();
    const Drive drive = route.DriveOf(lap, 1);
    const CampusDay day = BuildCampus(campus, MakeDay(drive.times.front(), {}, Weather::kClear, 1));
    const Scene scene(day.world, pictures);
    const Traffic traffic(campus, day.vehicles,
                          MakeDay(drive.times.front(), {}, Weather::kClear, 1), drive);
    int blocked = 0;
    for (std::size_t i = 0; i + 1 < drive.times.size(); ++i) {
      const Movers movers(scene, traffic.At(drive.times[i]));
      alignas(64) RTCRay16 rays{};
      alignas(64) std::array<int, kPacket> valid;
      valid.fill(-1);
      for (int k = 0; k < kPacket; ++k) {  // lengthwise through the car's body
        const Eigen::Vector3d rear =
            drive.world_from_car[i] *
            Eigen::Vector3d(-0.6, -0.75 + 0.5 * (k % 4), 0.45 + 0.5 * (k / 4));
        const Eigen::Vector3f ahead = drive.world_from_car[i].rotation().col(0).cast<float>();
        rays.org_x[k] = static_cast<float>(rear.x());
        rays.org_y[k] = static_cast<float>(rear.y());
        rays.org_z[k] = static_cast<float>(rear.z());
        rays.dir_x[k] = ahead.x();
        rays.dir_y[k] = ahead.y();
        rays.dir_z[k] = ahead.z();
        rays.tfar[k] = 4.0F;
        rays.mask[k] = ~0U;
      }
      scene.Occluded(rays, valid.data(), &movers);
      for (int k = 0; k < kPacket; ++k) blocked += rays.tfar[k] < 0 ? 1 : 0;
    }
    EXPECT_EQ(blocked, 0) << "lap " << lap;
  }
}

}  // namespace
}  // namespace recollect::simulation
