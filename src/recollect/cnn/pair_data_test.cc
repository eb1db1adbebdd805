#include "recollect/cnn/pair_data.h"

#include <gtest/gtest.h>

#include <array>
#include <opencv2/core.hpp>

#include "recollect/cnn/augment.h"
#include "recollect/cnn/loader.h"
#include "recollect/cnn/test_street.h"
#include "recollect/cnn/training_data.h"
#include "recollect/core/error.h"

namespace recollect::cnn {
namespace {

TEST(CropTest, PapersWindowOfAFourByThreeImage) {
  EXPECT_EQ(Crop::Paper(640, 480), (Crop{640, 480, 160, 140, 320, 240}));
  EXPECT_EQ(Crop::Paper(1280, 960), (Crop{640, 480, 160, 140, 320, 240}));
}

TEST(CropTest, CarriesTheCameraAlong) {
  const PinholeCamera camera{1280, 960, 978.88, 978.88, 647.5, 474.5};
  const PinholeCamera cropped = Crop::Paper(1280, 960).Apply(camera);
  EXPECT_EQ(cropped.width, 320);
  EXPECT_EQ(cropped.height, 240);
  EXPECT_NEAR(cropped.fx, 489.44, 1e-9);
  EXPECT_NEAR(cropped.cx, 323.5 - 160, 1e-9);
  EXPECT_NEAR(cropped.cy, 237 - 140, 1e-9);
}

TEST(CropTest, FitsAnyAspect) {
  for (const auto& [width, height] : {std::pair{828, 250}, {1226, 370}, {480, 640}, {640, 480}}) {
    const cv::Mat image(height, width, CV_8UC1, cv::Scalar(7));
    const cv::Mat paper = Crop::Paper(width, height).Apply(image);
    EXPECT_EQ(paper.size(), cv::Size(320, 240));
    EXPECT_EQ(paper.type(), CV_8UC3);
    const Crop compact = Crop::Compact(width, height);
    EXPECT_EQ(compact.Apply(image).size(), cv::Size(compact.width, compact.height));
    EXPECT_EQ(compact.width % 16 + compact.height % 16, 0);
    EXPECT_NEAR(compact.width * compact.height, 320 * 192, 13000);
  }
}

TEST(CropTest, RefusesWhatItCannotTake) {
  EXPECT_THROW(Crop::Compact(0, 10), Error);
  EXPECT_THROW(Crop::Compact(1000, 100), Error);
  EXPECT_THROW(Crop::Paper(10, 0), Error);
  const Crop crop = Crop::Compact(640, 480);
  EXPECT_THROW(crop.Apply(cv::Mat(250, 828, CV_8UC3)), Error);
  EXPECT_THROW(crop.Apply(cv::Mat(480, 640, CV_32FC3)), Error);
  EXPECT_THROW(crop.Apply(cv::Mat()), Error);
  EXPECT_THROW(crop.Apply(PinholeCamera{828, 250, 1, 1, 0, 0}), Error);
}

TEST(Contrast, IsBlindToGainAndOffset) {
  cv::Mat image(96, 160, CV_8UC3);
  cv::randu(image, 40, 120);
  cv::Mat brighter;
  image.convertTo(brighter, CV_8U, 2, 10);
  cv::Mat a(3 * image.rows, image.cols, CV_32F), b = a.clone();
  PrepareImage(NetworkKind::kCompact, image, a.ptr<float>());
  PrepareImage(NetworkKind::kCompact, brighter, b.ptr<float>());
  EXPECT_GT(cv::norm(a, cv::NORM_L1) / static_cast<double>(a.total()), 0.5);
  EXPECT_LT(cv::norm(a, b, cv::NORM_L1) / static_cast<double>(a.total()), 0.15);
  EXPECT_LT(std::abs(cv::mean(a)[0]), 0.1);
}

class PairDataTest : public ::testing::Test {
 protected:
  PairData Load(const PairOptions& options = {}) {
    return LoadPairs(street_.laps(), street_.laps(), Crop::Compact(320, 240), options, pool_);
  }
  Batch Nth(const PairData& data, LoaderOptions options, int n) {
    Loader loader(data, options);
    for (int i = 0; i < n; ++i) loader.Next();
    return loader.Next();
  }

  TestStreet street_{{{.length_m = 7}, {.length_m = 7, .lateral_m = 1, .seed = 2}}};
  ThreadPool pool_{2};
};

TEST_F(PairDataTest, HoldsEveryPairButTheFramesWithThemselves) {
  const PairData data = Load({.max_distance_m = 3.3});
  ASSERT_FALSE(data.pairs.empty());
  for (const Pair& pair : data.pairs) {
    EXPECT_NE(pair.live, pair.key);
    EXPECT_LE(data.KeyframeFromLive(pair).translation().norm(), 3.3);
  }
  std::size_t expected = 0;
  for (const Lap& live : street_.laps()) {
    for (const Lap& key : street_.laps()) {
      for (std::size_t i = 0; i < live.frames.size(); ++i) {
        for (std::size_t j = 0; j < key.frames.size(); ++j) {
          const double distance =
              (live.WorldFromCamera(i).translation() - key.WorldFromCamera(j).translation()).norm();
          expected += distance <= 3.3 && !(&live == &key && i == j);
        }
      }
    }
  }
  EXPECT_EQ(data.pairs.size(), expected);
}

TEST_F(PairDataTest, DepthIsThatOfTheCropsPixels) {
  const PairData data = Load();
  const PinholeCamera grid = data.camera.Subsampled(kDepthStep);
  ASSERT_EQ(data.frames[0].depth.size(), cv::Size(grid.width, grid.height));
  // The road: level, a fixed height below the camera.
  const double z = data.frames[0].depth.at<float>(grid.height - 1, grid.width / 2);
  const Eigen::Vector3d low =
      data.frames[0].world_from_camera * grid.Unproject(grid.width / 2, grid.height - 1, z);
  EXPECT_NEAR(low.z(), 0, 0.15);
}

TEST_F(PairDataTest, RefusesRoadsThatDoNotMeet) {
  EXPECT_THROW(Load({.max_distance_m = 0.01}), Error);
}

TEST_F(PairDataTest, SplitKeepsBlocksApart) {
  const TestStreet long_street({{.length_m = 120, .spacing_m = 3}});
  const PairData all =
      LoadPairs(long_street.laps(), long_street.laps(), Crop::Compact(320, 240), {}, pool_);
  const auto [train, valid] = SplitRoad(all, 0.3, 1);
  EXPECT_FALSE(train.pairs.empty());
  EXPECT_FALSE(valid.pairs.empty());
  EXPECT_LT(train.pairs.size() + valid.pairs.size(), all.pairs.size());
  for (const Pair& a : train.pairs) {
    for (const Pair& b : valid.pairs) {
      EXPECT_TRUE(a.live != b.live && a.live != b.key && a.key != b.live && a.key != b.key);
    }
  }
  EXPECT_THROW(SplitRoad(Load(), 0.5, 1), Error);  // a single block
}

TEST_F(PairDataTest, LoaderIsDeterminedBySeedAndNumber) {
  const PairData data = Load();
  const LoaderOptions options{.batch = 4, .augment = true, .seed = 3};
  const Batch a = Nth(data, options, 2), b = Nth(data, options, 2);
  EXPECT_TRUE(torch::equal(a.live, b.live) && torch::equal(a.key, b.key));
  EXPECT_TRUE(torch::equal(a.motion, b.motion) && torch::equal(a.depth, b.depth));

  Loader later(data, options, 2);  // as a resumed training begins
  EXPECT_TRUE(torch::equal(later.Next().live, a.live));

  LoaderOptions other = options;
  other.seed = 4;
  EXPECT_FALSE(torch::equal(Nth(data, other, 2).live, a.live));
}

TEST_F(PairDataTest, AnEpochSeesEachPairOnce) {
  const PairData data = Load();
  const LoaderOptions options{.batch = 2};
  Loader loader(data, options);
  std::vector<std::array<float, 2>> seen;
  const std::int64_t batches = Loader::BatchesPerEpoch(data, options.batch);
  for (std::int64_t i = 0; i < batches; ++i) {
    const Batch batch = loader.Next();
    for (int j = 0; j < batch.motion.size(0); ++j) {
      seen.push_back({batch.motion[j][0][3].item<float>(), batch.motion[j][2][3].item<float>()});
    }
  }
  std::sort(seen.begin(), seen.end());
  EXPECT_EQ(std::adjacent_find(seen.begin(), seen.end()), seen.end());
  EXPECT_GE(seen.size() + 1, data.pairs.size());
}

TEST_F(PairDataTest, LightChangesWithItsSeedOnly) {
  const cv::Mat image = Load().frames[0].image;
  Random a(1), b(1), c(2);
  const cv::Mat first = AugmentLight(image, a);
  EXPECT_EQ(cv::norm(first, AugmentLight(image, b), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(first, AugmentLight(image, c), cv::NORM_INF), 0);
}

}  // namespace
}  // namespace recollect::cnn
