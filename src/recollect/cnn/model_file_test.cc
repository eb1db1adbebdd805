#include <gtest/gtest.h>
#include <torch/torch.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <functional>
#include <opencv2/core.hpp>

#include "recollect/cnn/pair_errors.h"
#include "recollect/cnn/pair_network.h"
#include "recollect/cnn/pose_network.h"
#include "recollect/cnn/tensor_file.h"
#include "recollect/cnn/test_street.h"
#include "recollect/core/error.h"
#include "recollect/core/files.h"

namespace recollect::cnn {
namespace {

ModelInfo Info() {
  ModelInfo info;
  info.crop = Crop::Compact(640, 480);
  info.camera = info.crop.Apply(PinholeCamera{640, 480, 489, 489, 320, 240});
  info.seed = 42;
  info.laps = {"lap-01", "lap-02"};
  info.steps = 7;
  info.validated_on = "nothing";
  info.validation.position_mean_m = 0.5;
  return info;
}

class ModelFile : public ::testing::Test {
 protected:
  ModelFile() {
    torch::manual_seed(1);
    const ModelInfo info = Info();
    PoseNetwork(info, MakeNetwork(info.network, info.camera)).Save(file_);
  }

  // The message that loading the file gives after `change` was made to its bytes.
  std::string ErrorAfter(const std::function<void(std::string&)>& change) {
    std::string bytes = ReadFile(file_);
    change(bytes);
    AtomicWrite(file_, bytes);
    try {
      PoseNetwork::Load(file_, 1);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }

  TestStreet folder_{{}};
  const std::filesystem::path file_ = folder_.File("test.model");
};

TEST_F(ModelFile, RoundTrip) {
  const PoseNetwork first = PoseNetwork::Load(file_, 1);
  EXPECT_EQ(first.info().laps, Info().laps);
  EXPECT_EQ(first.info().seed, 42U);
  EXPECT_EQ(first.info().validation.position_mean_m, 0.5);
  EXPECT_EQ(first.crop(), Info().crop);
  EXPECT_EQ(first.info().camera, Info().camera);

  const auto again = folder_.File("again.model");
  first.Save(again);
  EXPECT_EQ(ReadFile(again), ReadFile(file_));

  cv::Mat live(192, 320, CV_8UC3), key(192, 320, CV_8UC3);
  cv::randu(live, 0, 255);
  cv::randu(key, 0, 255);
  EXPECT_EQ(first.KeyframeFromLive(live, key).Matrix(),
            PoseNetwork::Load(again, 1).KeyframeFromLive(live, key).Matrix());
  EXPECT_THROW(first.KeyframeFromLive(live, key.colRange(0, 100)), Error);
}

TEST_F(ModelFile, MissingForeignEmpty) {
  EXPECT_THROW(PoseNetwork::Load(folder_.File("none.model"), 1), Error);
  EXPECT_NE(ErrorAfter([](std::string& b) { b = "PNG"; }).find("not a model file"),
            std::string::npos);
  EXPECT_NE(ErrorAfter([](std::string& b) { b.clear(); }).find("not a model file"),
            std::string::npos);
}

TEST_F(ModelFile, CutShortAtAnyPlace) {
  const std::string whole = ReadFile(file_);
  for (const double share : {0.001, 0.5, 0.999}) {
    const auto length = static_cast<std::size_t>(share * static_cast<double>(whole.size()));
    EXPECT_NE(ErrorAfter([&](std::string& b) { b = whole.substr(0, length); }).find("cut short"),
              std::string::npos);
  }
  for (const std::size_t length : {8U, 12U, 20U}) {
    EXPECT_NE(ErrorAfter([&](std::string& b) { b = whole.substr(0, length); }).find("cut short"),
              std::string::npos);
  }
}

TEST_F(ModelFile, AlteredOrLonger) {
  EXPECT_NE(ErrorAfter([](std::string& b) { b[b.size() / 2] ^= 1; }).find("damaged"),
            std::string::npos);
  EXPECT_NE(ErrorAfter([](std::string& b) { b += "more"; }).find("damaged"), std::string::npos);
}

TEST_F(ModelFile, HeadersThatLie) {
  const TensorFile good = ReadTensorFile(file_);
  const auto error = [&](const std::function<void(TensorFile&)>& change) {
    TensorFile file = good;
    change(file);
    WriteTensorFile(file_, file);
    return ErrorAfter([](std::string&) {});
  };
  EXPECT_NE(error([](TensorFile& f) { f.header.erase("model"); }).find("not a model"),
            std::string::npos);
  EXPECT_NE(error([](TensorFile& f) { f.header["model"].erase("crop"); }).find("description"),
            std::string::npos);
  EXPECT_NE(error([](TensorFile& f) { f.header["model"]["network"] = "z"; }).find("'z'"),
            std::string::npos);
  EXPECT_NE(error([](TensorFile& f) { f.header["model"]["crop"]["left"] = 9; }).find("crop"),
            std::string::npos);
  EXPECT_NE(error([](TensorFile& f) { f.tensors.pop_back(); }).find("another network"),
            std::string::npos);
  EXPECT_NE(error([](TensorFile& f) { f.tensors[0].second = torch::zeros(3); }).find("shape"),
            std::string::npos);
}

// A network whose head was moved off its beginning, so that it says something of each pair.
PoseNetwork WithCovariance() {
  torch::manual_seed(5);
  ModelInfo info = Info();
  info.covariance = CovarianceCalibration{2.5, {0.5, -1, 2}, {0.1, 0.2, -0.3}};
  const auto network = MakeNetwork(info.network, info.camera, true);
  const torch::NoGradGuard no_gradients;
  for (auto& parameter : network->named_parameters()) {
    if (parameter.key().starts_with(kCovarianceWeights)) {
      parameter.value().add_(0.02 * torch::randn_like(parameter.value()));
    }
  }
  return {info, network};
}

TEST_F(ModelFile, CovarianceSurvivesTheRoundTrip) {
  const PoseNetwork first = WithCovariance();
  first.Save(file_);
  const PoseNetwork second = PoseNetwork::Load(file_, 1);
  EXPECT_EQ(second.info().covariance, first.info().covariance);
  cv::Mat live(192, 320, CV_8UC3), key(192, 320, CV_8UC3), other(192, 320, CV_8UC3);
  for (cv::Mat* image : {&live, &key, &other}) cv::randu(*image, 0, 255);
  const std::vector<CropPair> pairs{{live, key}, {live, other}};
  const auto before = first.Estimate(pairs), after = second.Estimate(pairs);
  for (std::size_t i = 0; i < 2; ++i) {
    ASSERT_TRUE(before[i].covariance && after[i].covariance);
    EXPECT_EQ(*before[i].covariance, *after[i].covariance);
    EXPECT_GT(before[i].covariance->llt().matrixL().determinant(), 0);
    EXPECT_TRUE(before[i].keyframe_from_live.Matrix().isApprox(
        second.KeyframeFromLive(pairs)[i].Matrix(), 1e-5));
  }
  EXPECT_FALSE(before[0].covariance->isApprox(*before[1].covariance, 1e-6));

  // The scale is one of covariances.
  ModelInfo twice = second.info();
  twice.covariance->scale = 5;
  const auto larger = PoseNetwork(twice, second.network()).Estimate(pairs);
  EXPECT_TRUE(larger[0].covariance->isApprox(2 * *before[0].covariance, 1e-9));
}

TEST_F(ModelFile, WithoutCovarianceThereIsNone) {
  cv::Mat image(192, 320, CV_8UC3);
  cv::randu(image, 0, 255);
  const CropPair pair{image, image};
  EXPECT_FALSE(PoseNetwork::Load(file_, 1).Estimate({&pair, 1}).front().covariance);
  EXPECT_THROW(MakeNetwork(NetworkKind::kPaperB, {}, true), Error);
}

// Training from a model without covariance begins with a fresh one, and with the model's answers.
TEST_F(ModelFile, StartsACovarianceFromAModelWithoutOne) {
  ModelInfo info = Info();
  info.covariance.emplace();
  torch::manual_seed(8);
  const auto network = MakeNetwork(info.network, info.camera, true);
  CopyWeights(file_, info.network, *network);
  cv::Mat live(192, 320, CV_8UC3), key(192, 320, CV_8UC3);
  cv::randu(live, 0, 255);
  cv::randu(key, 0, 255);
  const CropPair pair{live, key};
  const RelativeEstimate estimate = PoseNetwork(info, network).Estimate({&pair, 1}).front();
  EXPECT_EQ(estimate.keyframe_from_live.Matrix(),
            PoseNetwork::Load(file_, 1).KeyframeFromLive(live, key).Matrix());
  Vector6d variances;
  variances << 1e-4, 1e-4, 1e-4, 0.09, 0.09, 0.09;
  ASSERT_TRUE(estimate.covariance);
  EXPECT_TRUE(estimate.covariance->isApprox(Matrix6d(variances.asDiagonal()), 1e-5));
}

// The model that the repository carries was written before there were covariances.
TEST(EarlierModel, Loads) {
  const std::filesystem::path file = "models/campus-compact.rcm";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
  const PoseNetwork network = PoseNetwork::Load(file, 1);
  EXPECT_FALSE(network.info().covariance);
  EXPECT_GT(network.info().validation.position_mean_m, 0);
  EXPECT_FALSE(network.info().validation.inside_95);
  const Crop& crop = network.crop();
  const cv::Mat image(crop.height, crop.width, CV_8UC3, cv::Scalar(1, 2, 3));
  const CropPair pair{image, image};
  const RelativeEstimate estimate = network.Estimate({&pair, 1}).front();
  EXPECT_FALSE(estimate.covariance);
  EXPECT_EQ(estimate.keyframe_from_live.Matrix(), network.KeyframeFromLive(image, image).Matrix());
}

PairErrors ErrorsOf(int count) {
  PairErrors errors;
  for (int i = 0; i < count; ++i) {
    errors.position_m.push_back(i + 1);
    errors.heading_deg.push_back(count - i);
    errors.agreement.emplace_back(0.1 * (i % 3), 0, -0.2 * (i % 5));
    errors.pose_square.push_back(0.37 * ((7 * i) % count + 1));
    errors.position_square.push_back(0.01 * (i + 1));
  }
  return errors;
}

TEST(PairErrorsOf, CalibrationPutsNinetyFivePercentInside) {
  for (const int count : {1, 7, 20, 101, 600}) {
    PairErrors errors = ErrorsOf(count);
    errors.Apply(errors.Calibration());
    const auto inside = static_cast<int>(std::lround(*errors.Figures().inside_95 * count));
    EXPECT_EQ(inside, static_cast<int>(std::ceil(0.95 * count))) << count;
  }
  EXPECT_EQ(PairErrors().Calibration(), CovarianceCalibration());
}

TEST(PairErrorsOf, FiguresSayWhatMostErrorsStayBelow) {
  const PairFigures figures = ErrorsOf(100).Figures();
  EXPECT_EQ(figures.position_p95_m, 95);
  EXPECT_EQ(figures.heading_p95_deg, 95);
  EXPECT_NEAR(*figures.inside_95, 0.34, 1e-12);          // 12.592 / 0.37
  EXPECT_NEAR(*figures.position_inside_95, 1.0, 1e-12);  // up to 1.0 of 7.815
  EXPECT_FALSE(PairErrors().Figures().inside_95);
}

TEST(PairErrorsOf, UntrainedNetworkIsNoMotion) {
  const PoseNetwork network = PoseNetwork::Untrained(640, 480);
  const cv::Mat image(240, 320, CV_8UC3, cv::Scalar(1, 2, 3));
  EXPECT_TRUE(network.KeyframeFromLive(image, image).Matrix().isApprox(SE3().Matrix()));
}

}  // namespace
}  // namespace recollect::cnn
