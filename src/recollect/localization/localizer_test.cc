#include "recollect/localization/localizer.h"

#include <gtest/gtest.h>
#include <cmath>
#include <filesystem>
#include <optional>

#include "recollect/cnn/pair_network.h"
#include "recollect/core/parallel.h"
#include "recollect/matching/mapped.h"
#include "recollect/testing/scratch_folder.h"
#include "recollect/testing/street.h"

namespace recollect {
namespace {

namespace fs = std::filesystem;

// A street with landmarks, key frames every metre; the live images are the mapped ones.
class LocalizerTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_.emplace();
    const Lap lap = testing::DriveStreet(*folder_ / "lap", {.length_m = 40, .seed = 1});
    MapOptions options;
    options.spacing_m = 1;
    options.geometry = matching::LandmarkSource();
    CreateMap(*folder_ / "m.map", std::span(&lap, 1), options, pool_);
  }
  static void TearDownTestSuite() { folder_.reset(); }

  Localizer Make(const LocalizerOptions& options) { return {map_, std::nullopt, pool_, options}; }

  inline static std::optional<testing::ScratchFolder> folder_;
  inline static ThreadPool pool_{2};
  Map map_ = Map::Open(*folder_ / "m.map");
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

// Before any training: "no motion" or nearly, with errors of 0.01 rad and 0.3 m.
cnn::PoseNetwork Network(const Map& map, std::optional<cnn::CovarianceCalibration> covariance) {
  const PinholeCamera& camera = map.description().camera.left;
  cnn::ModelInfo info;
  info.crop = cnn::DefaultCrop(info.network, camera.width, camera.height);
  info.camera = info.crop.Apply(camera);
  info.validation.pairs = 10;
  info.validation.position_mean_m = 0.5;
  info.validation.heading_mean_deg = 1;
  info.covariance = covariance;
  return {info, cnn::MakeNetwork(info.network, info.camera, covariance.has_value())};
}

TEST_F(LocalizerTest, TheNetworksAnswerIsAsSureAsItSays) {
  LocalizerOptions options;
  options.relative = Relative::kCnn;
  const Localization said =
      Localizer(map_, Network(map_, cnn::CovarianceCalibration{.scale = 4}), pool_, options)
          .Localize(map_.Image(20));
  Vector6d variances;
  variances << 4e-4, 4e-4, 4e-4, 0.36, 0.36, 0.36;
  EXPECT_TRUE(said.covariance.isApprox(Matrix6d(variances.asDiagonal()), 1e-5)) << said.covariance;
  // A network that says nothing is as sure as it was right on its validation pairs.
  const Localization silent =
      Localizer(map_, Network(map_, std::nullopt), pool_, options).Localize(map_.Image(20));
  EXPECT_NEAR(silent.covariance(5, 5), 0.25, 1e-9);
  EXPECT_NEAR(std::sqrt(silent.covariance(0, 0)), 0.0175, 1e-4);
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
