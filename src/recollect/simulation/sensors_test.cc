#include "recollect/simulation/sensors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <opencv2/core.hpp>

#include "recollect/core/error.h"
#include "recollect/core/random.h"
#include "recollect/simulation/faults.h"

namespace recollect::simulation {
namespace {

TEST(Utm, CentralMeridianAndMeridianArc) {
  // 20 degrees south on the central meridian: the meridian arc is 2,212,366.3 m.
  const Geodetic place = FromUtm(1e7 - 0.9996 * 2212366.28, 500000);
  EXPECT_NEAR(place.latitude, -20, 2e-6);
  EXPECT_NEAR(place.longitude, -39, 1e-12);
  const Geodetic campus = FromUtm(7757729, 363562);
  EXPECT_NEAR(campus.latitude, -20.275, 0.01);
  EXPECT_NEAR(campus.longitude, -40.305, 0.01);
}

TEST(Gps, HasTheQualityAndErrorsOfTheRealOne) {
  std::vector<double> times;
  std::vector<Eigen::Vector3d> positions;
  for (int i = 0; i < 20000; ++i) {
    times.push_back(i * 0.2);
    positions.emplace_back(i, 0.1 * i, 0);
  }
  const auto fixes = SimulateGps(
      times, positions, [](const Eigen::Vector3d& p) { return 0.7 + 0.3 * std::sin(p.x() / 40); },
      5);
  std::map<int, double> count, error;
  int runs = 0;
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    count[fixes[i].quality] += 1;
    error[fixes[i].quality] += (fixes[i].p_world - positions[i]).head<2>().norm();
    if (i > 0 && fixes[i].quality != fixes[i - 1].quality) ++runs;
  }
  EXPECT_NEAR(1 - count[0] / 20000, 0.897, 0.005);
  EXPECT_NEAR(error[4] / count[4], 0.20, 0.03);
  EXPECT_NEAR(error[2] / count[2], 0.60, 0.1);
  EXPECT_NEAR(error[5] / count[5], 0.60, 0.2);
  EXPECT_LT(runs, 6000);  // qualities come in stretches
}

TEST(Gps, SentencesCarryTheirCheckSum) {
  GpsFix fix;
  fix.quality = 4;
  const std::string text = GgaSentence(fix, 1511378411.87, {7757729, 363562});
  EXPECT_EQ(text.substr(0, 17), "$GPGGA,192011.87,");
  EXPECT_NE(text.find(",S,0401"), std::string::npos);  // 40 degrees 18 minutes
  unsigned sum = 0;
  for (std::size_t i = 1; i < text.find('*'); ++i) sum ^= static_cast<unsigned char>(text[i]);
  EXPECT_EQ(text.substr(text.find('*')), fmt::format("*{:02X}", sum));
}

TEST(Wheels, TellTheMotion) {
  Drive drive;
  constexpr double kRate = 0.2, kSpeed = 6;  // a circle to the left
  for (int i = 0; i < 500; ++i) {
    const double t = i * 0.06, yaw = kRate * t, r = kSpeed / kRate;
    drive.times.push_back(t);
    drive.world_from_car.push_back(
        SE3::FromRotationVector({0, 0, yaw}, {r * std::sin(yaw), -r * std::cos(yaw), 0}));
  }
  double speed = 0, steering = 0;
  const auto readings = SimulateWheels(drive, 3);
  for (const WheelReading& w : readings) speed += w.speed / 500, steering += w.steering / 500;
  EXPECT_NEAR(speed, kSpeed, 0.08);
  EXPECT_NEAR(steering, std::atan(2.625 * kRate / kSpeed), 0.007);
}

TEST(Faults, AreParsedAndDrawn) {
  const FaultPlan plan = ParseFaults("black=0.2,frozen");
  ASSERT_EQ(plan.entries.size(), 2U);
  int black = 0;
  for (std::int64_t i = 0; i < 6000; ++i) black += FaultOf(plan, i, 1) == Fault::kBlack ? 1 : 0;
  EXPECT_NEAR(black / 6000.0, 0.2, 0.03);
  EXPECT_EQ(FaultOf(ParseFaults("none"), 7, 1), Fault::kNone);
  EXPECT_EQ(ParseFaults("all").entries.size(), 6U);
  for (const char* wrong :
       {"rain", "black=2", "black=x", "black=", "black=0.5,frozen=0.5", ",", "=0.1"}) {
    EXPECT_THROW(ParseFaults(wrong), Error) << wrong;
  }
}

TEST(Faults, OfACameraComeInTheirOrder) {
  FaultyCamera camera(ParseFaults("frozen=0.4,overexposed=0.3"), 3);
  std::map<std::string, int> seen;
  cv::Mat shown;
  for (int i = 0; i < 60; ++i) {
    const cv::Mat taken(4, 4, CV_8UC3, cv::Scalar(i, i, i));
    cv::Mat image = taken.clone();
    const std::string fault = camera.Take(image);
    ++seen[fault];
    if (fault == "frozen") {
      EXPECT_EQ(cv::norm(image, shown, cv::NORM_INF), 0);  // what was shown before
    } else {
      EXPECT_EQ(image.at<cv::Vec3b>(0, 0)[0], fault == "none" ? i : 3 * i);
    }
    shown = image.clone();
  }
  EXPECT_EQ(seen.size(), 3U);
}

TEST(Faults, SpoilPictures) {
  const cv::Mat clean(48, 64, CV_8UC3, cv::Scalar(100, 120, 140));
  cv::Mat black = clean.clone(), half = clean.clone();
  Spoil(Fault::kBlack, 1, black);
  EXPECT_LT(cv::mean(black)[0], 5);
  Spoil(Fault::kHalfOccluded, 1, half);
  EXPECT_NEAR(cv::mean(half)[0], 52, 8);
}

}  // namespace
}  // namespace recollect::simulation
