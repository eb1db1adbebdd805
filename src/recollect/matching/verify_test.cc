// Places on the test street: the right one is found among wrong ones, its pose is right and its
// covariance tells the truth; what cannot be located is not.
#include "recollect/matching/verify.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/dataset/image.h"
#include "recollect/dataset/sampling.h"
#include "recollect/matching/mapped.h"
#include "recollect/testing/scratch_folder.h"
#include "recollect/testing/street.h"

namespace recollect::matching {
namespace {

namespace fs = std::filesystem;

class VerifyTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_.emplace();
    laps_ = {testing::DriveStreet(*folder_ / "1", {.length_m = 32, .lateral_m = 0.5, .seed = 1}),
             testing::DriveStreet(*folder_ / "2", {.length_m = 32, .lateral_m = -0.6, .seed = 2})};
    live_ = testing::DriveStreet(*folder_ / "3", {.length_m = 32, .brightness = 0.5, .seed = 3});
    ThreadPool pool(2);
    MapOptions options;
    options.network.neurons_x = options.network.neurons_y = 4;
    options.geometry = LandmarkSource();
    CreateMap(*folder_ / "depth.map", laps_, options, pool);
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static Features Live(std::size_t frame) {
    return FindFeatures(ReadGray(live_.frames[frame].left));
  }
  // Key frames by distance to a live frame.
  static std::vector<int> ByDistance(const MappedFrames& map, std::size_t frame) {
    std::vector<std::pair<double, int>> keys;
    for (const SE3& pose : map.world_from_camera) {
      keys.emplace_back((pose.translation() - live_.WorldFromCamera(frame).translation()).norm(),
                        static_cast<int>(keys.size()));
    }
    std::sort(keys.begin(), keys.end());
    std::vector<int> order;
    for (const auto& [distance, key] : keys) order.push_back(key);
    return order;
  }

  static std::optional<testing::ScratchFolder> folder_;
  static std::vector<Lap> laps_;
  static Lap live_;
};
std::optional<testing::ScratchFolder> VerifyTest::folder_;
std::vector<Lap> VerifyTest::laps_;
Lap VerifyTest::live_;

TEST_F(VerifyTest, FindsPosesFromTheRightPlaceAmongWrongOnes) {
  for (Lap& lap : laps_) {
    for (Frame& frame : lap.frames) frame.depth.clear();
  }
  ThreadPool pool(2);
  MapOptions options;
  options.network.neurons_x = options.network.neurons_y = 4;
  options.geometry = LandmarkSource();
  CreateMap(*folder_ / "motion.map", laps_, options, pool);
  for (const char* name : {"depth.map", "motion.map"}) {
    SCOPED_TRACE(name);
    const Map map = Map::Open(*folder_ / name);
    ASSERT_TRUE(map.HasGeometry());
    const MappedFrames frames = FramesOf(map);
    int sure = 0, asked = 0;
    for (std::size_t frame = 6; frame < 26; frame += 4) {
      SCOPED_TRACE(frame);
      const std::vector<int> order = ByDistance(frames, frame);
      const std::vector<int> proposals = {order[order.size() - 1], order[order.size() - 3],
                                          order[0]};
      const auto found = VerifyPlaces(frames, Live(frame), proposals);
      ++asked;
      if (!found || !IsSure(*found)) continue;
      ++sure;
      EXPECT_LT(
          (found->world_from_camera.translation() - live_.WorldFromCamera(frame).translation())
              .norm(),
          0.15);
      EXPECT_LT((found->world_from_camera.Inverse() * live_.WorldFromCamera(frame)).Angle(), 0.01);
    }
    EXPECT_GE(sure, asked - 1);
  }
}

// Each key frame is there twice, 5 m apart: the pose is found at the copy where it is expected. (Of
// the bound on matches, expected_px, this says nothing.)
TEST_F(VerifyTest, FindsThePoseWhereItIsExpected) {
  const Map map = Map::Open(*folder_ / "depth.map");
  MappedFrames frames = FramesOf(map);
  frames.lap.clear();  // of the copies it is not known
  const auto count = static_cast<int>(frames.world_from_camera.size());
  const Eigen::Vector3d shift(5, 0, 0);
  for (int key = 0; key < count; ++key) {
    const SE3 pose = frames.world_from_camera[static_cast<std::size_t>(key)];
    frames.world_from_camera.emplace_back(pose.rotation(), pose.translation() + shift);
  }
  frames.landmarks = [of_map = frames.landmarks, count](int key) { return of_map(key % count); };
  for (const std::size_t frame : {std::size_t{8}, std::size_t{14}, std::size_t{20}}) {
    SCOPED_TRACE(frame);
    const SE3 truth = live_.WorldFromCamera(frame);
    for (const double repeat : {0.0, 1.0}) {
      const Eigen::Vector3d there = truth.translation() + repeat * shift;
      const auto found = VerifyExpected(
          frames, Live(frame), SE3(truth.rotation(), there + Eigen::Vector3d(0.4, 0.1, 0)));
      ASSERT_TRUE(found);
      EXPECT_LT((found->world_from_camera.translation() - there).norm(), 0.2);
    }
  }
  EXPECT_FALSE(VerifyExpected(frames, Live(8),
                              SE3(Eigen::Matrix3d::Identity(), Eigen::Vector3d(500, 0, 0))));
}

// The street is there once more, far off, and there with all its landmarks, here with three of
// four.
TEST_F(VerifyTest, TakesTheLikelierOfPlacesThatLookTheSame) {
  const Map map = Map::Open(*folder_ / "depth.map");
  MappedFrames frames = FramesOf(map);
  frames.lap.clear();  // of the copies it is not known
  const auto count = static_cast<int>(frames.world_from_camera.size());
  const Eigen::Vector3d far(0, 500, 0);
  for (int key = 0; key < count; ++key) {
    const SE3 pose = frames.world_from_camera[static_cast<std::size_t>(key)];
    frames.world_from_camera.emplace_back(pose.rotation(), pose.translation() + far);
  }
  frames.landmarks = [of_map = frames.landmarks, count](int key) {
    const Landmarks all = of_map(key % count);
    if (key >= count) return all;
    Landmarks some;
    for (int i = 0; i < all.size(); ++i) {
      if (i % 4 == 0) continue;
      some.points.push_back(all.points[static_cast<std::size_t>(i)]);
      const std::int8_t* descriptor = all.descriptors.data() + i * kDescriptorBytes;
      some.descriptors.insert(some.descriptors.end(), descriptor, descriptor + kDescriptorBytes);
    }
    return some;
  };
  const int here = ByDistance(FramesOf(map), 14).front(), there = here + count;
  const Eigen::Vector3d truth = live_.WorldFromCamera(14).translation();
  for (const auto& order : {std::vector{here, there}, std::vector{there, here}}) {
    const auto found = VerifyPlaces(frames, Live(14), order);
    ASSERT_TRUE(found);
    const Eigen::Vector3d expected =
        truth + (order.front() == there ? far : Eigen::Vector3d(0, 0, 0));
    EXPECT_LT((found->world_from_camera.translation() - expected).norm(), 0.2);
    EXPECT_GT(found->rival, 0);
    EXPECT_FALSE(IsSure(*found));
  }
}

TEST_F(VerifyTest, KnowsWhatItDoesNotKnow) {
  const Map map = Map::Open(*folder_ / "depth.map");
  const MappedFrames frames = FramesOf(map);
  for (std::size_t frame = 4; frame < 13; frame += 4) {
    std::vector<int> order = ByDistance(frames, frame);
    std::reverse(order.begin(), order.end());
    order.resize(6);  // twenty metres and more away; what is there is seen from here, but small
    const auto found = VerifyPlaces(frames, Live(frame), order);
    if (!found || !IsSure(*found)) continue;
    EXPECT_LT((found->world_from_camera.translation() - live_.WorldFromCamera(frame).translation())
                  .norm(),
              0.3)
        << "support " << found->support << ", spread " << found->spread << ", agreed "
        << found->agreed << " (" << found->agreed_share << "), rival " << found->rival;
  }

  // Images that show nothing.
  const std::vector<int> all = ByDistance(frames, 10);
  const cv::Mat black(240, 320, CV_8UC1, cv::Scalar(3));
  EXPECT_FALSE(VerifyPlaces(frames, FindFeatures(black), all));
  cv::Mat noise(240, 320, CV_8UC1);
  cv::theRNG().state = 5;
  cv::randu(noise, 0, 255);
  const auto in_noise = VerifyPlaces(frames, FindFeatures(noise), all);
  EXPECT_TRUE(!in_noise || !IsSure(*in_noise));
  EXPECT_FALSE(VerifyPlaces(frames, Live(10), {}));

  // From its own laps.
  ThreadPool pool(2);
  const Calibration calibration = CalibrateGeometry(map, pool);
  EXPECT_EQ(calibration.images, map.size());
  if (calibration.sure >= 20) {
    EXPECT_GT(calibration.inflation, 0.3);
    EXPECT_LT(calibration.inflation, 5);
  }
  CalibrateMap(*folder_ / "depth.map", pool);
  EXPECT_DOUBLE_EQ(Map::Open(*folder_ / "depth.map").description().geometry_inflation,
                   calibration.inflation);
}

// The image is 320 pixels wide: half the width of the look that is meant for one of 640.
TEST_F(VerifyTest, RefinesRoughPosesThatANarrowLookWouldConfirm) {
  const Map map = Map::Open(*folder_ / "depth.map");
  const MappedFrames frames = FramesOf(map);
  VerifyOptions wide, narrow;
  wide.guided_px[0] = 30;
  narrow.guided_px[0] = narrow.guided_px[1];
  narrow.guided_rounds = 1;
  double worst = 0, worst_narrow = 0;
  for (std::size_t frame = 4; frame < 24; frame += 4) {
    SCOPED_TRACE(frame);
    const SE3 truth = live_.WorldFromCamera(frame);
    const SE3 rough = truth * SE3::FromRotationVector({0, 0.015, 0}, {0.4, 0, 0.5});
    const auto off = [&](const VerifyOptions& options) {
      const auto found = RefineFrom(frames, Live(frame), rough, options);
      return found ? (found->world_from_camera.translation() - truth.translation()).norm() : 1.0;
    };
    worst = std::max(worst, off(wide));
    worst_narrow = std::max(worst_narrow, off(narrow));
  }
  EXPECT_LT(worst, 0.1);
  EXPECT_GT(worst_narrow, 0.2);
}

TEST(IsSure, IsNotOfFewOrClusteredMatches) {
  Verified good;
  good.support = 60;
  good.spread = 0.5;
  good.agreed = 40;
  good.agreed_share = 0.7;
  EXPECT_TRUE(IsSure(good));
  Verified few = good, clustered = good, ambiguous = good, vague = good, guided = good,
           split = good;
  few.support = 9;
  clustered.spread = 0.05;
  ambiguous.rival = 35;
  guided.agreed = 0;
  split.agreed_share = 0.2;
  vague.covariance = Matrix6d::Identity();
  for (const Verified& bad : {few, clustered, ambiguous, vague, guided, split})
    EXPECT_FALSE(IsSure(bad));
}

}  // namespace
}  // namespace recollect::matching
