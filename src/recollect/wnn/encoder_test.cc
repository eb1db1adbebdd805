#include "recollect/wnn/encoder.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <vector>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/core/random.h"

namespace recollect::wnn {
namespace {

cv::Mat Noise(int width, int height, int channels, std::uint64_t seed) {
  cv::Mat image(height, width, channels == 3 ? CV_8UC3 : CV_8UC1);
  Random random(seed);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width * channels; ++x) {
      image.ptr(y)[x] = static_cast<std::uint8_t>(random.Index(256));
    }
  }
  return image;
}

ImageView View(const cv::Mat& image) {
  return {image.data, image.cols, image.rows, image.channels(),
          static_cast<std::ptrdiff_t>(image.step)};
}

int Value(const cv::Mat& image, Pixel at, Code code) {
  if (image.channels() == 1) return image.at<std::uint8_t>(at.y, at.x);
  const auto bgr = image.at<cv::Vec3b>(at.y, at.x);
  if (code == Code::kColour) return bgr[2] + 256 * bgr[1] + 65536 * bgr[0];
  cv::Mat gray;
  cv::cvtColor(image(cv::Rect(at.x, at.y, 1, 1)), gray, cv::COLOR_BGR2GRAY);
  return gray.at<std::uint8_t>(0, 0);
}

// The bits as the method's text has them, one at a time.
void ExpectBits(const cv::Mat& image, const NetworkOptions& options) {
  ThreadPool pool(2);
  Encoder encoder(options, image.cols, image.rows, pool);
  const Synapses& synapses = encoder.synapses();
  const cv::Mat window = image.rowRange(0, synapses.window_height()).clone();
  cv::Mat sharp = window;
  if (options.code == Code::kGray && image.channels() == 3) {
    cv::cvtColor(window, sharp, cv::COLOR_BGR2GRAY);
  }
  cv::Mat blurred = sharp.clone();
  if (options.blur) {
    const double scale = image.cols / 640.0;
    const int size = 2 * static_cast<int>(std::lround(16 * scale)) + 1;
    cv::GaussianBlur(sharp, blurred, cv::Size(size, size), 11 * scale);
  }
  const std::vector<std::uint64_t> pattern = encoder.Encode(View(image));
  ASSERT_EQ(pattern.size(), static_cast<std::size_t>(synapses.neurons()) * 2);
  for (int n = 0; n < synapses.neurons(); ++n) {
    for (int i = 0; i < 128; ++i) {
      const auto value = [&](int s) {
        return Value(s < 128 - options.gaussian_synapses ? sharp : blurred, synapses.Of(n)[s],
                     options.code);
      };
      const bool expected = value(i) < value((i + 1) % 128);
      const auto word = pattern[static_cast<std::size_t>(2 * n + i / 64)];
      ASSERT_EQ((word >> (i % 64)) & 1, expected ? 1u : 0u)
          << "neuron " << n << " bit " << i << " blur " << options.blur << " channels "
          << image.channels() << " gray " << (options.code == Code::kGray);
    }
  }
}

TEST(Encoder, GivesTheBitsOfTheDefinition) {
  NetworkOptions options;
  options.neurons_x = 24;
  options.neurons_y = 13;
  for (const Code code : {Code::kColour, Code::kGray}) {
    for (const bool blur : {false, true}) {
      for (const int channels : {1, 3}) {
        options.code = code;
        options.blur = blur;
        ExpectBits(Noise(160, 120, channels, 5), options);
      }
    }
  }
  options.gaussian_synapses = 128;
  ExpectBits(Noise(97, 20, 3, 6), options);
  options.gaussian_synapses = 0;
  ExpectBits(Noise(64, 64, 1, 7), options);
}

TEST(Encoder, BlueDecidesInTheColourCodeOnly) {
  cv::Mat image = Noise(64, 36, 3, 8), more_red = image.clone();
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      auto& pixel = more_red.at<cv::Vec3b>(y, x);
      pixel[2] = static_cast<std::uint8_t>(255 - pixel[2]);
    }
  }
  ThreadPool pool(1);
  const auto changed = [&](Code code) {
    NetworkOptions options;
    options.code = code;
    options.blur = false;
    Encoder encoder(options, 64, 36, pool);
    const auto a = encoder.Encode(View(image)), b = encoder.Encode(View(more_red));
    int bits = 0;
    for (std::size_t i = 0; i < a.size(); ++i) bits += std::popcount(a[i] ^ b[i]);
    return bits / (128.0 * 5184);
  };
  EXPECT_LT(changed(Code::kColour), 0.01);
  EXPECT_GT(changed(Code::kGray), 0.05);
}

TEST(Encoder, ReadsRowsByTheirStrideAndIgnoresWhatLiesBelowTheWindow) {
  cv::Mat image = Noise(160, 120, 3, 9), wide = Noise(200, 120, 3, 10);
  image.copyTo(wide(cv::Rect(0, 0, 160, 120)));
  ThreadPool pool(2);
  Encoder encoder({}, 160, 120, pool);
  const auto expected = encoder.Encode(View(image));
  wide.rowRange(91, 120).setTo(0);
  EXPECT_EQ(encoder.Encode(View(wide(cv::Rect(0, 0, 160, 120)))), expected);
}

TEST(Encoder, ShiftLooksBesideTheTruePlace) {
  NetworkOptions options;
  options.blur = false;
  const cv::Mat image = Noise(160, 120, 1, 11);
  cv::Mat moved(120, 160, CV_8UC1);
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      moved.at<std::uint8_t>(y, x) =
          image.at<std::uint8_t>(std::max(0, y - 2), std::min(159, x + 3));
    }
  }
  ThreadPool pool(1);
  Encoder encoder(options, 160, 120, pool);
  EXPECT_EQ(encoder.Encode(View(image), {3, -2}), encoder.Encode(View(moved)));
}

TEST(Encoder, RefusesAnotherSizeOfImage) {
  ThreadPool pool(1);
  Encoder encoder({}, 160, 120, pool);
  EXPECT_THROW(encoder.Encode(View(Noise(160, 121, 3, 1))), Error);
  ImageView image = View(Noise(160, 120, 3, 1));
  image.channels = 2;
  EXPECT_THROW(encoder.Encode(image), Error);
  EXPECT_THROW(encoder.Encode(ImageView{}), Error);
}

}  // namespace
}  // namespace recollect::wnn
