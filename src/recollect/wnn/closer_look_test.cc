#include "recollect/wnn/closer_look.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/wnn/displaced.h"
#include "recollect/wnn/sabgl.h"
#include "recollect/wnn/test_scene.h"

namespace recollect::wnn {
namespace {

// The scene zoomed about its centre, then moved right and down by so many pixels.
cv::Mat Moved(const cv::Mat& scene, double zoom, double x, double y) {
  const cv::Mat motion = (cv::Mat_<double>(2, 3) << zoom, 0, (1 - zoom) * scene.cols / 2 + x, 0,
                          zoom, (1 - zoom) * scene.rows / 2 + y);
  cv::Mat moved;
  cv::warpAffine(scene, moved, motion, scene.size(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return moved;
}

struct Scenes {
  explicit Scenes(int count, int threads = 2) : pool(threads) {
    for (int i = 0; i < count; ++i) {
      memory.Append(encoder.Encode(View(Scene(static_cast<std::uint64_t>(i)))));
    }
  }
  std::vector<Look> LookAt(const cv::Mat& live) {
    const Displacements grid = encoder.closer_displacements();
    const DisplacedImage image = encoder.LookDisplaced(View(live), grid);
    std::vector<int> all(static_cast<std::size_t>(memory.entries()));
    std::iota(all.begin(), all.end(), 0);
    const auto near = NearDistances(memory, image.Every(4), all, pool);
    return LookCloser(memory, image, near, all, encoder.parts(), pool);
  }
  ThreadPool pool;
  NetworkOptions options = RecollectNetwork();
  Encoder encoder{options, 320, 240, pool};
  Memory memory{options.neurons()};
};

TEST(CloserLook, FindsTheDisplacementBetweenCoarseSteps) {
  Scenes scenes(12);
  const Displacements grid = scenes.encoder.closer_displacements();
  ASSERT_EQ(grid.columns, 33);
  ASSERT_EQ(grid.rows, 17);
  // 4 pixels of 320 right, 2 up: two steps of 4 pixels of 640 right, one up.
  const auto looks = scenes.LookAt(Moved(Scene(5), 1, 4, -2));
  for (int i = 0; i < 12; ++i) {
    if (i != 5) {
      EXPECT_LT(looks[static_cast<std::size_t>(i)].halves, looks[5].halves / 3) << i;
    }
  }
  EXPECT_GT(looks[5].halves, scenes.options.neurons());
  // Of equal votes the first displacement is told.
  EXPECT_NEAR(looks[5].displacements[0] % 33, 16 + 2, 2);
  EXPECT_NEAR(looks[5].displacements[0] / 33, 8 - 1, 2);
}

TEST(CloserLook, TellsViewsOfOneSceneApart) {
  // A road of views: each entry is nearer to the scene by eight parts in a hundred than the one
  // before. Live ones are the same, darker and moved by
  // half a coarse step (12 pixels of 320). Of the whole image: parts moved each in its own way
  // make one of these views of the other.
  NetworkOptions options = RecollectNetwork();
  options.parts_x = options.parts_y = 0;
  const auto right = [&](int closer_step) {
    options.closer_step = closer_step;
    ThreadPool pool(2);
    Encoder encoder(options, 320, 240, pool);
    Memory memory(options.neurons());
    constexpr int kScenes = 4, kViews = 6;
    const auto view = [](int scene, int i) {
      return Moved(Scene(static_cast<std::uint64_t>(scene)), 1 + 0.08 * i, 0, 0);
    };
    for (int scene = 0; scene < kScenes; ++scene) {
      for (int i = 0; i < kViews; ++i) memory.Append(encoder.Encode(View(view(scene, i))));
    }
    int right = 0;
    for (int scene = 0; scene < kScenes; ++scene) {
      for (int i = 0; i < kViews; ++i) {
        const cv::Mat live = 0.6 * Moved(view(scene, i), 1, 12, -4);
        right += RecollectImage(memory, encoder, View(live), pool).winner == scene * kViews + i;
      }
    }
    return right;
  };
  const int coarse = right(0), closer = right(4);
  EXPECT_GE(closer, 17);
  EXPECT_GT(closer, coarse);
}

TEST(CloserLook, FindsPlacesWhosePartsHaveMovedApart) {
  // As on the other side of a street: what is left of the middle has moved one way, what is right
  // of it the other way, and here and there something else stands.
  Scenes scenes(12);
  cv::Mat live = Moved(Scene(5), 1, -18, 4);
  Moved(Scene(5), 1, 18, -4).colRange(160, 320).copyTo(live.colRange(160, 320));
  for (const int x : {40, 230}) live(cv::Rect(x, 40, 50, 60)).setTo(cv::Scalar(90, 90, 90));
  const auto looks = scenes.LookAt(live);
  std::vector<int> parts = scenes.encoder.parts();
  ASSERT_EQ(parts.size(), 576U);
  EXPECT_EQ(*std::max_element(parts.begin(), parts.end()), 23);
  // Both sides find their own displacement, 16 -+ 9 steps of 4 pixels of 640.
  ASSERT_EQ(looks[5].displacements.size(), 25U);
  int left = 0, right = 0;
  for (std::size_t part = 0; part < 24; ++part) {
    const int x = looks[5].displacements[1 + part] % 33;
    (part % 8 < 4 ? left : right) += std::abs(x - (part % 8 < 4 ? 16 - 9 : 16 + 9)) <= 2;
  }
  EXPECT_GE(left, 9);
  EXPECT_GE(right, 9);
  // The whole image can agree with one side only.
  scenes.options.parts_x = scenes.options.parts_y = 0;
  scenes.encoder = Encoder(scenes.options, 320, 240, scenes.pool);
  const auto whole = scenes.LookAt(live);
  EXPECT_GT(looks[5].halves, 1.2 * whole[5].halves);
  for (std::size_t i = 0; i < 12; ++i) {
    if (i != 5) {
      EXPECT_LT(looks[i].halves, looks[5].halves / 2) << i;
    }
  }
}

TEST(CloserLook, WhatIsInEveryImageDoesNotVote) {
  ThreadPool pool(2);
  Encoder encoder(RecollectNetwork(), 320, 240, pool);
  Memory memory(RecollectNetwork().neurons());
  const cv::Mat bonnet = Scene(77);
  const auto with_bonnet = [&](std::uint64_t seed) {
    cv::Mat image = Scene(seed).clone();
    bonnet.colRange(0, 110).copyTo(image.colRange(0, 110));
    return image;
  };
  std::vector<int> all;
  for (std::uint64_t place = 0; place < 20; ++place) {
    all.push_back(memory.Append(encoder.Encode(View(with_bonnet(place)))));
  }
  const auto near = NearDistances(
      memory, encoder.EncodeDisplaced(View(with_bonnet(5)), encoder.displacements()), all, pool);
  int silent = 0, awake = 0, behind = 0, before = 0;
  for (int n = 0; n < memory.neurons(); ++n) {
    const Pixel cell = encoder.synapses().Cell(n);
    const bool votes = near[static_cast<std::size_t>(n)] >= 0;
    if (cell.x < 7) {  // 70 pixels: well behind the bonnet
      ++behind;
      silent += !votes;
    } else if (cell.x >= 14) {
      ++before;
      awake += votes;
    }
  }
  EXPECT_GT(silent, 0.95 * behind);
  EXPECT_GT(awake, 0.95 * before);
}

TEST(CloserLook, IsTheSameWithAnyNumberOfThreads) {
  Scenes one(8, 1), three(8, 3);
  const cv::Mat live = Moved(Scene(3), 1.05, 7, 3);
  const auto a = one.LookAt(live), b = three.LookAt(live);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].halves, b[i].halves);
    EXPECT_EQ(a[i].displacements, b[i].displacements);
  }
}

TEST(CloserLook, SequencesCompareDisplacedImages) {
  Scenes scenes(12);
  // Half the reach of the first look away.
  const cv::Mat live = Moved(Scene(5), 1, 24, 0);
  const auto still = MeanDistances(scenes.memory, scenes.encoder.Encode(View(live)), scenes.pool);
  const auto moved = DisplacedDistances(scenes.memory, scenes.encoder, View(live), scenes.pool);
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_LE(moved[i], still[i]);
    if (i != 5) {
      EXPECT_LT(moved[5], 0.8 * moved[i]);
    }
  }
  EXPECT_LT(moved[5], 0.8 * still[5]);
}

TEST(CloserLook, LooksOnlyWhereTheSearchMay) {
  Scenes scenes(12);
  EntrySet allowed(scenes.memory);
  allowed.AllowRange(0, 5).AllowRange(6, 12);
  const Recollection found =
      RecollectImage(scenes.memory, scenes.encoder, View(Moved(Scene(5), 1, 4, -2)), scenes.pool,
                     {.allowed = &allowed});
  EXPECT_NE(found.winner, 5);
  for (const LabelVotes& one : found.histogram) EXPECT_NE(one.label, 5);
}

TEST(CloserLook, AStepThatDoesNotDivideIsRefused) {
  NetworkOptions options = RecollectNetwork();
  options.closer_step = 5;
  EXPECT_THROW(CloserDisplacementsOf(options), Error);
  options.closer_step = -4;
  EXPECT_THROW(CloserDisplacementsOf(options), Error);
}

}  // namespace
}  // namespace recollect::wnn
