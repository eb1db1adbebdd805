#include "recollect/localization/localizer.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "recollect/core/parallel.h"
#include "recollect/matching/mapped.h"
#include "recollect/testing/street.h"

namespace recollect {
namespace {

namespace fs = std::filesystem;

// A street with landmarks, key frames every metre; the live images are the mapped ones.
class LocalizerTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = fs::path(::testing::TempDir()) / ("recollect_localizer_" + std::to_string(getpid()));
    fs::remove_all(folder_);
    const Lap lap = testing::DriveStreet(folder_ / "lap", {.length_m = 40, .seed = 1});
    MapOptions options;
    options.spacing_m = 1;
    options.geometry = matching::LandmarkSource();
    CreateMap(folder_ / "m.map", std::span(&lap, 1), options, pool_);
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }

  Localizer Make(const LocalizerOptions& options) { return {map_, std::nullopt, pool_, options}; }

  inline static fs::path folder_;
  inline static ThreadPool pool_{2};
  Map map_ = Map::Open(folder_ / "m.map");
};

TEST_F(LocalizerTest, TheCommitteeIsTheWitnessOfASingleImage) {
  const Localization seconded = Make({}).Localize(map_.Image(20));
  EXPECT_EQ(seconded.state, State::kLocalised);
  // Nobody was so near to the key frame as this asks for.
  LocalizerOptions alone;
  alone.verify.place_m = 1e-5;
  const Localization answer = Make(alone).Localize(map_.Image(20));
  EXPECT_EQ(answer.state, State::kUncertain);
  EXPECT_LT(
      (answer.world_from_camera.translation() - seconded.world_from_camera.translation()).norm(),
      0.05);
}

TEST_F(LocalizerTest, AnAnswerAgainstTheDriveIsUncertain) {
  LocalizerOptions options;
  options.sequence.emplace();
  Localizer localizer = Make(options);
  for (const int key : {4, 5, 6, 7}) {
    EXPECT_EQ(localizer.Localize(map_.Image(key)).state, State::kLocalised) << key;
  }
  const Localization jumped = localizer.Localize(map_.Image(34));
  EXPECT_EQ(jumped.state, State::kUncertain);
  EXPECT_EQ(localizer.Localize(map_.Image(9)).state, State::kLocalised);
  localizer.Reset();
  EXPECT_EQ(localizer.Localize(map_.Image(34)).state, State::kLocalised);
}

TEST_F(LocalizerTest, ACameraThatHangsIsUncertain) {
  LocalizerOptions options;
  options.sequence.emplace();
  Localizer localizer = Make(options);
  EXPECT_EQ(localizer.Localize(map_.Image(10)).state, State::kLocalised);
  EXPECT_EQ(localizer.Localize(map_.Image(10)).state, State::kUncertain);
}

}  // namespace
}  // namespace recollect
