#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <opencv2/core.hpp>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/dataset/image.h"
#include "recollect/localization/localizer.h"
#include "recollect/map/trials.h"
#include "recollect/testing/scratch_folder.h"
#include "recollect/testing/street.h"

namespace recollect {
namespace {

namespace fs = std::filesystem;

// A user says how many of the places told are to be right; what the map is too unsure of is lost.
class RefusalTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::vector<Lap> mapped = {
        testing::DriveStreet(folder_ / "a", {.length_m = 60, .seed = 1}),
        testing::DriveStreet(folder_ / "b", {.length_m = 60, .lateral_m = 0.4, .seed = 2})};
    CreateMap(folder_ / "m.map", mapped, {}, pool_);
  }

  Localizer With(const Map& map, std::optional<double> precision) {
    LocalizerOptions options;
    options.relative = Relative::kCnn;
    options.precision = precision;
    options.explain = true;
    return {map, cnn::PoseNetwork::Untrained(320, 240), pool_, options};
  }

  testing::ScratchFolder folder_;
  ThreadPool pool_{2};
};

TEST_F(RefusalTest, ImagesFromNowhereAreUnknownAndThoseOfTheRoadAreNot) {
  CalibrateRecognition(folder_ / "m.map", pool_);
  const Map map = Map::Open(folder_ / "m.map");
  Localizer localizer = With(map, 0.9);
  const Lap live =
      testing::DriveStreet(folder_ / "c", {.length_m = 50, .lateral_m = 0.2, .seed = 3});
  int known = 0;
  double least = 1;
  for (std::size_t i = 0; i < live.frames.size(); i += 10) {
    const Localization answer = localizer.Localize(ReadColour(live.frames[i].left));
    ASSERT_TRUE(answer.probability);
    EXPECT_EQ(answer.recognised, answer.state != State::kLost);
    ASSERT_TRUE(answer.explanation);
    EXPECT_EQ(answer.explanation->winner.label, answer.key_frame);
    known += answer.recognised;
    if (answer.recognised) least = std::min(least, *answer.probability);
  }
  EXPECT_GE(known, 4);

  cv::RNG random(5);
  const auto& camera = map.description().camera.left;
  cv::Mat noise(camera.height, camera.width, CV_8UC3);
  random.fill(noise, cv::RNG::UNIFORM, 0, 256);
  for (const cv::Mat& image : {noise, cv::Mat(noise.size(), CV_8UC3, cv::Scalar::all(90))}) {
    const Localization answer = localizer.Localize(image);
    EXPECT_FALSE(answer.recognised);
    EXPECT_EQ(answer.state, State::kLost);
    EXPECT_LT(*answer.probability, least);
  }
}

TEST_F(RefusalTest, NeedsAMapThatTellsHowSureItIs) {
  const Map map = Map::Open(folder_ / "m.map");
  EXPECT_THROW(With(map, 0.9), Error);
  EXPECT_FALSE(With(map, std::nullopt).Localize(map.Image(2)).probability);
}

}  // namespace
}  // namespace recollect
