#include "recollect/cnn/onnx_export.h"

#include <gtest/gtest.h>
#include <torch/torch.h>

#include <opencv2/core.hpp>
#include <opencv2/dnn.hpp>

#include "recollect/cnn/layers.h"
#include "recollect/cnn/loader.h"
#include "recollect/cnn/pair_network.h"
#include "recollect/cnn/test_street.h"
#include "recollect/core/error.h"

namespace recollect::cnn {
namespace {

PoseNetwork Lively(NetworkKind kind) {
  torch::manual_seed(12);
  ModelInfo info;
  info.network = kind;
  info.crop = DefaultCrop(kind, 640, 480);
  const auto network =
      MakeNetwork(kind, info.crop.Apply(PinholeCamera{640, 480, 489, 489, 320, 240}));
  const torch::NoGradGuard no_gradients;
  for (auto& parameter : network->parameters()) {
    if (parameter.dim() == 4 && parameter.size(0) == 6) parameter.normal_(0, 0.01);
    if (parameter.dim() == 1) parameter.add_(torch::randn_like(parameter) * 0.02);
  }
  return {info, network};
}

cv::Mat Blob(const PoseNetwork& network, const cv::Mat& image) {
  const std::vector<int> shape = {1, 3, image.rows, image.cols};
  cv::Mat values(shape, CV_32F);
  PrepareImage(network.info().network, image, values.ptr<float>());
  return values;
}

class OnnxExport : public ::testing::TestWithParam<NetworkKind> {};

TEST_P(OnnxExport, OpenCvGivesOurAnswers) {
  const TestStreet folder{{}};
  const PoseNetwork network = Lively(GetParam());
  std::filesystem::create_directories(folder.File("x").parent_path());
  ExportOnnx(network, folder.File("network.onnx"));
  cv::dnn::Net net = cv::dnn::readNetFromONNX(folder.File("network.onnx").string());
  cv::RNG random(3);
  for (int i = 0; i < 3; ++i) {
    cv::Mat live(network.crop().height, network.crop().width, CV_8UC3), key = live.clone();
    random.fill(live, cv::RNG::UNIFORM, 0, 255);
    random.fill(key, cv::RNG::UNIFORM, 0, 255);
    net.setInput(Blob(network, live), "live");
    net.setInput(Blob(network, key), "key");
    const cv::Mat delta = net.forward("delta");
    ASSERT_EQ(delta.total(), 6U);
    const Vector6d ours = DeltaFromMotion(network.KeyframeFromLive(live, key));
    ASSERT_GT(ours.norm(), 0.01);
    for (int j = 0; j < 6; ++j) EXPECT_NEAR(delta.ptr<float>()[j], ours[j], 1e-4) << j;
  }
}

INSTANTIATE_TEST_SUITE_P(Variants, OnnxExport,
                         ::testing::Values(NetworkKind::kPaperA, NetworkKind::kPaperB));

TEST(OnnxExportOf, TheCompactNetworkIsRefused) {
  try {
    ExportOnnx(Lively(NetworkKind::kCompact), "compact.onnx");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("least squares"), std::string::npos);
  }
}

}  // namespace
}  // namespace recollect::cnn
