// The network against the figures it is known to reach on images that are no part of the project.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <filesystem>
#include <opencv2/core.hpp>
#include <set>

#include "recollect/core/parallel.h"
#include "recollect/dataset/image.h"
#include "recollect/dataset/image_folder.h"
#include "recollect/dataset/reader.h"
#include "recollect/dataset/sampling.h"
#include "recollect/wnn/encoder.h"
#include "recollect/wnn/search.h"

namespace recollect::wnn {
namespace {

namespace fs = std::filesystem;
const fs::path kData = RECOLLECT_SHARED_DATA;

#define SKIP_WITHOUT(folder) \
  if (!fs::is_directory(kData / folder)) GTEST_SKIP() << "no " << (kData / folder)

std::vector<std::uint64_t> Encode(Encoder& encoder, const cv::Mat& image) {
  return encoder.Encode({image.data, image.cols, image.rows, image.channels(),
                         static_cast<std::ptrdiff_t>(image.step)});
}

std::vector<double> CorridorShares(const NetworkOptions& options) {
  ThreadPool pool;
  Encoder encoder(options, 160, 120, pool);
  Memory memory(options.neurons());
  for (const fs::path& path : ImagesIn(kData / "corridor/ref")) {
    memory.Append(Encode(encoder, ReadColour(path)));
  }
  std::vector<int> answers, truths;
  for (const fs::path& path : ImagesIn(kData / "corridor/query")) {
    truths.push_back(static_cast<int>(answers.size()));
    const auto pattern = Encode(encoder, ReadColour(path));
    answers.push_back(Recollect(memory, pattern, pool, {.tie_seed = options.seed}).winner);
  }
  return SharesWithin(answers, truths, std::vector<int>{0, 3});
}

TEST(Places, CorridorAsTheReferenceNetworkOverSeeds) {
  SKIP_WITHOUT("corridor");
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    const auto shares = CorridorShares({.seed = seed});
    EXPECT_GE(shares[0], 0.11) << "seed " << seed;
    EXPECT_LE(shares[0], 0.17) << "seed " << seed;
    EXPECT_GE(shares[1], 0.48) << "seed " << seed;
    EXPECT_LE(shares[1], 0.55) << "seed " << seed;
  }
}

TEST(Places, CorridorInGrayIsWorse) {
  SKIP_WITHOUT("corridor");
  double gray = 0;
  for (const std::uint64_t seed : {1, 2, 3}) {
    gray += CorridorShares({.code = Code::kGray, .seed = seed})[1] / 3;
  }
  EXPECT_NEAR(gray, 0.459, 0.04);
}

// Map laps 01-03 at 5 m, live lap 04 at 1 m, at dusk.
TEST(Places, KeyFramesOfADuskLapLieWithinMetres) {
  SKIP_WITHOUT("torcs-wheel");
  const std::vector<Lap> laps = ReadLaps(kData / "torcs-wheel");
  ASSERT_EQ(laps.size(), 4u);
  ThreadPool pool;
  Encoder encoder({}, 640, 480, pool);
  Memory memory(encoder.synapses().neurons());
  std::vector<Eigen::Vector3d> places;
  for (std::size_t lap = 0; lap < 3; ++lap) {
    for (const std::size_t i : SampleFrames(laps[lap], 5.0)) {
      memory.Append(Encode(encoder, ReadColour(laps[lap].frames[i].left)));
      places.push_back(laps[lap].WorldFromCamera(i).translation());
    }
  }
  int within_5 = 0, within_10 = 0, images = 0;
  for (const std::size_t i : SampleFrames(laps[3], 1.0)) {
    const auto pattern = Encode(encoder, ReadColour(laps[3].frames[i].left));
    const auto key = static_cast<std::size_t>(Recollect(memory, pattern, pool).winner);
    const double error = (places[key] - laps[3].WorldFromCamera(i).translation()).norm();
    within_5 += error <= 5;
    within_10 += error <= 10;
    ++images;
  }
  EXPECT_GE(within_5, 0.53 * images);
  EXPECT_LE(within_5, 0.63 * images);
  EXPECT_GE(within_10, 0.70 * images);
  EXPECT_LE(within_10, 0.80 * images);
}

}  // namespace
}  // namespace recollect::wnn
