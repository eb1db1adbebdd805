#include "recollect/wnn/shrink.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace recollect::wnn {
namespace {

TEST(Shrink, IsOpenCvsAreaScalingBitForBit) {
  cv::RNG random(5);
  for (const int type : {CV_8UC1, CV_8UC3}) {
    for (int factor = 2; factor <= 17; ++factor) {
      for (const int more : {0, 1, factor - 1}) {  // pixels that make the factor an uneven one
        cv::Mat image(factor * 12, factor * 20 + more, type);
        // Few gray levels: sums that lie half-way between two means are frequent.
        random.fill(image, cv::RNG::UNIFORM, 250, 256);
        cv::Mat expected;
        cv::resize(image, expected, {20, 12}, 0, 0, cv::INTER_AREA);
        for (const int rows : {12, 7}) {
          const cv::Mat shrunk = Shrunk(image, {20, 12}, rows);
          ASSERT_EQ(shrunk.size(), cv::Size(20, rows));
          EXPECT_EQ(cv::norm(shrunk, expected.rowRange(0, rows), cv::NORM_INF), 0)
              << factor << " " << more;
        }
      }
    }
  }
}

}  // namespace
}  // namespace recollect::wnn
