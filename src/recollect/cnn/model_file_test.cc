#include <gtest/gtest.h>
#include <torch/torch.h>

#include <functional>
#include <opencv2/core.hpp>

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

TEST(PairErrorsOf, UntrainedNetworkIsNoMotion) {
  const PoseNetwork network = PoseNetwork::Untrained(640, 480);
  const cv::Mat image(240, 320, CV_8UC3, cv::Scalar(1, 2, 3));
  EXPECT_TRUE(network.KeyframeFromLive(image, image).Matrix().isApprox(SE3().Matrix()));
}

}  // namespace
}  // namespace recollect::cnn
