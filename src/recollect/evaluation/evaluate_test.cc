#include "recollect/evaluation/evaluate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <opencv2/core.hpp>

#include "recollect/core/error.h"
#include "recollect/core/files.h"
#include "recollect/core/parallel.h"
#include "recollect/dataset/image.h"
#include "recollect/evaluation/failures.h"
#include "recollect/evaluation/report.h"
#include "recollect/evaluation/trust.h"
#include "recollect/matching/mapped.h"
#include "recollect/testing/scratch_folder.h"
#include "recollect/testing/street.h"

namespace recollect {
namespace {

namespace fs = std::filesystem;

TEST(Compare, MeasuresCentresAndWhereCamerasLook) {
  const SE3 truth = SE3::FromRotationVector({0.1, 0.2, 0.3}, {1, 2, 3});
  const SE3 shifted(truth.rotation(), truth.translation() + Eigen::Vector3d(0.3, 0, 0.4));
  EXPECT_NEAR(Compare(shifted, truth).position_m, 0.5, 1e-12);
  EXPECT_NEAR(Compare(shifted, truth).heading_deg, 0, 1e-6);
  const double angle = 3 * std::numbers::pi / 180;
  const SE3 yawed = truth * SE3::FromRotationVector({0, angle, 0}, {0, 0, 0});
  EXPECT_NEAR(Compare(yawed, truth).heading_deg, 3, 1e-9);
  EXPECT_NEAR(Compare(yawed, truth).position_m, 0, 1e-12);
  // Roll about the optical axis is no change of heading.
  const SE3 rolled = truth * SE3::FromRotationVector({0, 0, 0.5}, {0, 0, 0});
  EXPECT_NEAR(Compare(rolled, truth).heading_deg, 0, 1e-6);
}

// With an untrained network (its output layer is zero: "no motion") the system's row must equal
// retrieval's and oracle_cnn's the oracle's; every figure can then be checked from poses alone.
class EvaluateTest : public ::testing::Test {
 protected:
  void SetUp() override {
    mapped_ = {testing::DriveStreet(folder_ / "lap-01", {.length_m = 30, .seed = 1})};
    live_ = testing::DriveStreet(folder_ / "lap-02", {.length_m = 20, .lateral_m = 0.3, .seed = 2});
    CreateMap(folder_ / "m.map", mapped_, {}, pool_);
  }

  Localizer Untrained(const Map& map) {
    return {map, cnn::PoseNetwork::Untrained(320, 240), pool_};
  }

  testing::ScratchFolder folder_;
  ThreadPool pool_{2};
  std::vector<Lap> mapped_;
  Lap live_;
};

TEST_F(EvaluateTest, SetsTheSystemBesideItsBaselines) {
  for (int i = 0; i < 20; i += 2) {  // fixes on every other frame, half a metre off
    live_.gps.push_back({live_.frames[static_cast<std::size_t>(i)].time + 0.01,
                         live_.WorldFromCamera(static_cast<std::size_t>(i)).translation() +
                             Eigen::Vector3d(0, 0.5, 0),
                         i == 0 ? 0 : 4});
  }
  for (GpsFix& fix : live_.gps) fix.time *= 10;  // a tenth of a second a frame becomes a second
  for (Frame& frame : live_.frames) frame.time *= 10;
  const Map map = Map::Open(folder_ / "m.map");
  Localizer localizer = Untrained(map);
  const Evaluation e = Evaluate(localizer, live_);

  ASSERT_EQ(e.frames.size(), 20u);
  ASSERT_EQ(e.rows.size(), 5u);
  EXPECT_EQ(e.rows[0].name, "system");
  EXPECT_NEAR(e.rows[0].position_m.mean, e.rows[1].position_m.mean, 1e-9);
  EXPECT_NEAR(e.rows[2].position_m.mean, e.rows[3].position_m.mean, 1e-9);
  // Key frames stand every 5 m, so live frames 0 to 2 m before or behind: 1.2 m on average, and
  // 0.3 m to the side.
  double expected = 0;
  for (const double along : {0, 1, 2, 2, 1}) expected += std::hypot(along, 0.3) / 5;
  EXPECT_NEAR(e.rows[2].position_m.mean, expected, 1e-6);
  EXPECT_GE(e.rows[1].position_m.mean, e.rows[2].position_m.mean);
  EXPECT_EQ(e.rows[4].name, "gps");
  EXPECT_NEAR(e.rows[4].availability, 9.0 / 20, 1e-12);
  EXPECT_NEAR(e.rows[4].position_m.max, 0.5, 1e-9);
  EXPECT_GE(e.within_labels.at(1), 0.65);
  for (const LiveFrame& f : e.frames) {
    ASSERT_FALSE(f.answer.votes.empty());
    EXPECT_LE(f.answer.votes.size(), 5u);
    EXPECT_EQ(f.answer.votes.front().label, f.answer.key_frame);
    EXPECT_GE(f.answer.votes.front().votes, f.answer.votes.back().votes);
  }
  EXPECT_EQ(e.within_labels.at(10), 1);
}

TEST_F(EvaluateTest, RefusesForeignCamerasAndEmptyLaps) {
  const Map map = Map::Open(folder_ / "m.map");
  Localizer localizer = Untrained(map);
  EXPECT_THROW(localizer.Localize(cv::Mat(480, 640, CV_8UC3, cv::Scalar())), Error);
  EXPECT_THROW(localizer.Localize(cv::Mat(240, 320, CV_8UC1, cv::Scalar())), Error);
  EXPECT_THROW(localizer.Localize(cv::Mat()), Error);
  live_.frames.resize(1);
  EXPECT_THROW(Evaluate(localizer, live_), Error);
}

TEST_F(EvaluateTest, GivesTheSameAnswersWithAnyNumberOfThreads) {
  const Map map = Map::Open(folder_ / "m.map");
  Localizer two = Untrained(map);
  ThreadPool one_thread(1);
  Localizer one(map, cnn::PoseNetwork::Untrained(320, 240), one_thread);
  for (const Frame& frame : live_.frames) {
    const cv::Mat image = ReadColour(frame.left);
    const Localization a = one.Localize(image), b = two.Localize(image);
    EXPECT_EQ(a.key_frame, b.key_frame);
    EXPECT_EQ(a.confidence, b.confidence);
    EXPECT_EQ(a.world_from_camera.Matrix(), b.world_from_camera.Matrix());
  }
}

TEST_F(EvaluateTest, GeometryNeedsNoNetworkAndKnowsWhenItIsRight) {
  MapOptions options;
  options.geometry = matching::LandmarkSource();
  CreateMap(folder_ / "g.map", mapped_, options, pool_);
  const Map map = Map::Open(folder_ / "g.map");
  Localizer localizer(map, std::nullopt, pool_);
  EXPECT_EQ(localizer.relative(), Relative::kPnp);
  const Evaluation e = Evaluate(localizer, live_);
  SCOPED_TRACE(FormatTable(e));
  ASSERT_EQ(e.rows.size(), 5u);
  EXPECT_EQ(e.rows[0].name, "retrieval");
  EXPECT_EQ(e.rows[2].name, "pnp_oracle");
  EXPECT_LT(e.rows[2].position_m.median, 0.1);
  EXPECT_EQ(e.rows[4].name, "localised");
  EXPECT_GE(e.rows[4].availability, 0.5);
  EXPECT_LT(e.rows[4].position_m.max, 0.5);
  ASSERT_TRUE(e.trust);
  EXPECT_NEAR(e.trust->state_shares.at("localised"), e.rows[4].availability, 1e-12);
  EXPECT_DOUBLE_EQ(e.trust->localised_max_m, e.rows[4].position_m.max);
  EXPECT_GE(e.trust->place_after, e.trust->place_before);

  // Both together, with a network that always says "no motion".
  Localizer both(map, cnn::PoseNetwork::Untrained(320, 240), pool_);
  EXPECT_EQ(both.relative(), Relative::kFused);
  const cv::Mat image = ReadColour(live_.frames[7].left);
  const Localization by_pnp = localizer.Localize(image), fused = both.Localize(image);
  if (by_pnp.state == State::kLocalised) {
    EXPECT_EQ(fused.world_from_camera.Matrix(), by_pnp.world_from_camera.Matrix());
    EXPECT_EQ(fused.carried_by, Relative::kPnp);
  }
  const Localization dark = both.Localize(cv::Mat(240, 320, CV_8UC3, cv::Scalar(2, 2, 2)));
  EXPECT_EQ(dark.state, State::kLost);
  EXPECT_GT(dark.covariance.diagonal().minCoeff(), 0);

  // What cannot be done is refused.
  const Map plain = Map::Open(folder_ / "m.map");
  EXPECT_THROW(Localizer(plain, std::nullopt, pool_), Error);
  LocalizerOptions wanted;
  wanted.relative = Relative::kPnp;
  EXPECT_THROW(Localizer(plain, std::nullopt, pool_, wanted), Error);
  wanted.relative = Relative::kCnn;
  EXPECT_THROW(Localizer(map, std::nullopt, pool_, wanted), Error);
}

TEST_F(EvaluateTest, NothingIsKnownFromACameraThatHangs) {
  MapOptions options;
  options.geometry = matching::LandmarkSource();
  CreateMap(folder_ / "g.map", mapped_, options, pool_);
  const Map map = Map::Open(folder_ / "g.map");
  for (const bool drive : {true, false}) {
    LocalizerOptions wanted;
    if (drive) wanted.sequence.emplace();
    Localizer localizer(map, std::nullopt, pool_, wanted);
    cv::Mat last;
    EvaluationOptions hanging;
    hanging.spoil = [&, image = 0](cv::Mat& picture) mutable -> std::string {
      const bool hangs = ++image % 5 == 0;
      if (hangs) picture = last.clone();
      last = picture.clone();
      return hangs ? "hangs" : "none";
    };
    const Evaluation e = Evaluate(localizer, live_, hanging);
    ASSERT_EQ(e.faults.size(), 2u);
    EXPECT_EQ(e.faults.at("hangs").frames, 4);
    EXPECT_EQ(e.faults.at("none").frames, 16);
    EXPECT_GE(e.faults.at("none").localised, 8);
    // Images by themselves cannot tell.
    EXPECT_EQ(e.faults.at("hangs").localised > 0, !drive);
    EXPECT_EQ(ToFigures(e)["faults"]["hangs"]["frames"], 4);
    EXPECT_NE(FormatTable(e).find("hangs"), std::string::npos);
    // A row each of the failures, three pictures wide.
    const auto failures = static_cast<int>(std::count_if(
        e.frames.begin(), e.frames.end(), [](const LiveFrame& f) { return !f.picture.empty(); }));
    const fs::path sheet = folder_ / (drive ? "drive.jpg" : "single.jpg");
    EXPECT_EQ(WriteFailures(e, map, sheet), failures);
    EXPECT_EQ(fs::exists(sheet), failures > 0);
    EXPECT_GE(failures, drive ? 4 : 0);
    if (failures > 0) {
      EXPECT_GT(ReadColour(sheet).cols, 3 * 320);
    }
  }
}

TEST_F(EvaluateTest, LeavesOutWhatTheMapWasMadeOf) {
  MapOptions options;
  options.geometry = matching::LandmarkSource();
  CreateMap(folder_ / "g.map", mapped_, options, pool_);
  const Map map = Map::Open(folder_ / "g.map");
  std::vector<std::size_t> frames(30);
  std::iota(frames.begin(), frames.end(), std::size_t{0});
  std::vector<std::size_t> between = frames, unseen = frames;
  LeaveOutMapped(map, mapped_[0], LeaveOut::kKeyFrames, between);
  EXPECT_EQ(between.size(), 24u);
  EXPECT_EQ(between.front(), 1u);
  LeaveOutMapped(map, mapped_[0], LeaveOut::kSources, unseen);
  EXPECT_LT(unseen.size(), between.size());
  LeaveOutMapped(map, live_, LeaveOut::kSources, frames);
  EXPECT_EQ(frames.size(), 30u);
}

TEST_F(EvaluateTest, FramesCsvHasALineAFrame) {
  const Map map = Map::Open(folder_ / "m.map");
  Localizer localizer = Untrained(map);
  const Evaluation e = Evaluate(localizer, live_);
  WriteFramesCsv(e, folder_ / "frames.csv");
  const std::string csv = ReadFile(folder_ / "frames.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 21);
  EXPECT_NE(FormatTable(e).find("oracle_cnn"), std::string::npos);
}

}  // namespace
}  // namespace recollect
