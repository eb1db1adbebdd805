#include "recollect/depth/motion.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "recollect/core/error.h"
#include "recollect/dataset/image.h"
#include "recollect/testing/scratch_folder.h"
#include "recollect/testing/street.h"

namespace recollect {
namespace {

class MotionDepth : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_.emplace();
    lap_ = new Lap(testing::DriveStreet(folder_->path(), {.length_m = 8}));
  }
  static void TearDownTestSuite() {
    folder_.reset();
    delete lap_;
  }
  static SE3 Between(std::size_t to, std::size_t from) {
    return lap_->WorldFromCamera(to).Inverse() * lap_->WorldFromCamera(from);
  }
  inline static std::optional<testing::ScratchFolder> folder_;
  static Lap* lap_;
};
Lap* MotionDepth::lap_ = nullptr;

TEST_F(MotionDepth, AgreesWithTheTrueDepth) {
  const cv::Mat depth =
      DepthFromMotion(ReadColour(lap_->frames[4].left), ReadColour(lap_->frames[3].left),
                      Between(3, 4), lap_->camera.left);
  const cv::Mat truth = ReadDepth(lap_->frames[4].depth, lap_->depth_unit);
  const int step = depth.cols / truth.cols;
  std::vector<double> errors;
  for (int v = 0; v < truth.rows; ++v) {
    for (int u = 0; u < truth.cols; ++u) {
      const double estimated = depth.at<float>(step * v, step * u), exact = truth.at<float>(v, u);
      if (estimated > 0 && exact > 0) errors.push_back(std::abs(std::log(estimated / exact)));
    }
  }
  ASSERT_GT(errors.size(), truth.total() / 10);
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  EXPECT_LT(*middle, 0.1);
}

TEST_F(MotionDepth, KnowsNothingWithoutParallax) {
  const cv::Mat image = ReadColour(lap_->frames[4].left);
  EXPECT_EQ(cv::countNonZero(DepthFromMotion(image, image, SE3(), lap_->camera.left)), 0);
}

TEST_F(MotionDepth, RefusesImagesOfAnotherSize) {
  const cv::Mat image = ReadColour(lap_->frames[4].left);
  EXPECT_THROW(DepthFromMotion(image, image(cv::Rect(0, 0, 10, 10)), SE3(), lap_->camera.left),
               Error);
}

}  // namespace
}  // namespace recollect
