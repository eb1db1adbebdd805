#include "recollect/wnn/invariant.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/wnn/displaced.h"
#include "recollect/wnn/test_scene.h"

namespace recollect::wnn {
namespace {

// Share of bits that differ.
double Change(const std::vector<std::uint64_t>& a, const std::vector<std::uint64_t>& b) {
  int bits = 0;
  for (std::size_t i = 0; i < a.size(); ++i) bits += std::popcount(a[i] ^ b[i]);
  return bits / (64.0 * static_cast<double>(a.size()));
}

double ChangeByLight(const NetworkOptions& options) {
  ThreadPool pool(1);
  const cv::Mat day = Scene(1);
  cv::Mat dusk = day.clone();  // darker, and the more so to the right
  for (int x = 0; x < dusk.cols; ++x) dusk.col(x) *= 0.9 - 0.6 * x / dusk.cols;
  Encoder encoder(options, day.cols, day.rows, pool);
  return Change(encoder.Encode(View(day)), encoder.Encode(View(dusk)));
}

TEST(Invariant, LocalContrastAndGradientsSurviveShadeThatComparesOfPixelsDoNot) {
  NetworkOptions plain;
  plain.code = Code::kGray;
  plain.blur = false;
  plain.neurons_x = 12;
  plain.neurons_y = 8;
  NetworkOptions contrast = plain, gradient = plain;
  contrast.contrast_sigma = 30;
  gradient.cells = Cells::kGradient;
  EXPECT_LT(ChangeByLight(contrast), 0.8 * ChangeByLight(plain));
  EXPECT_LT(ChangeByLight(gradient), 0.6 * ChangeByLight(plain));
}

TEST(Invariant, EveryKindOfCellIsAFunctionOfTheImageThatTellsPlacesApart) {
  ThreadPool pool(2);
  for (const Cells cells : {Cells::kCompare, Cells::kGradient, Cells::kRank}) {
    for (const Code code : {Code::kGray, Code::kOpponent}) {
      NetworkOptions options = RecollectNetwork();
      options.cells = cells;
      options.code = code;
      options.blur = true;
      options.gaussian_synapses = 64;
      options.blur_scales = 2;
      Encoder encoder(options, 320, 240, pool);
      const cv::Mat one = Scene(1), other = Scene(2);
      const auto pattern = encoder.Encode(View(one));
      EXPECT_EQ(pattern, encoder.Encode(View(one)));
      EXPECT_GT(Change(pattern, encoder.Encode(View(other))), 0.2);
    }
  }
}

TEST(Invariant, RankCellsSetHalfOfTheBits) {
  ThreadPool pool(1);
  NetworkOptions options = RecollectNetwork();
  options.cells = Cells::kRank;
  options.code = Code::kGray;
  Encoder encoder(options, 320, 240, pool);
  const auto pattern = encoder.Encode(View(Scene(3)));
  int bits = 0;
  for (const std::uint64_t word : pattern) bits += std::popcount(word);
  EXPECT_NEAR(bits / (64.0 * static_cast<double>(pattern.size())), 0.48, 0.04);
}

TEST(Invariant, ADisplacedImageIsFoundUnderItsDisplacement) {
  ThreadPool pool(2);
  const NetworkOptions options = RecollectNetwork();
  Encoder encoder(options, 320, 240, pool);
  Memory memory(options.neurons());
  for (std::uint64_t place = 0; place < 20; ++place) {
    memory.Append(encoder.Encode(View(Scene(place))));
  }
  // What was at x is now at x - 16: the live image must be looked at 16 pixels (32 of 640) left.
  const cv::Mat scene = Scene(7);
  const cv::Mat motion = (cv::Mat_<double>(2, 3) << 1, 0, -16, 0, 1, 8);
  cv::Mat live;
  cv::warpAffine(scene, live, motion, scene.size(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  const DisplacedPatterns patterns = encoder.EncodeDisplaced(View(live), encoder.displacements());
  const Displacements grid = encoder.displacements();
  ASSERT_EQ(grid.columns, 9);
  ASSERT_EQ(grid.rows, 5);
  const auto learnt = encoder.Encode(View(scene));
  int nearest = 0;
  for (int d = 0; d < grid.count(); ++d) {
    if (Change(patterns.Under(d), learnt) < Change(patterns.Under(nearest), learnt)) nearest = d;
  }
  EXPECT_EQ(nearest % 9, 4 - 2);
  EXPECT_EQ(nearest / 9, 2 + 1);

  const Recollection found = RecollectImage(memory, encoder, View(live), pool);
  EXPECT_EQ(found.winner, 7);
  EXPECT_GT(found.confidence, 0.5);
  EXPECT_EQ(found.neurons_read, options.neurons());
  NetworkOptions still = options;
  still.shift_x = still.shift_y = 0;
  Encoder unmoved(still, 320, 240, pool);
  EXPECT_LT(RecollectImage(memory, unmoved, View(live), pool).confidence, found.confidence);
}

TEST(Invariant, RowsOfDisplacementsAreTheSameAsEachAlone) {
  ThreadPool pool(2);
  for (const int width : {320, 640, 250}) {  // one working pixel a step, and uneven steps
    for (const Cells cells : {Cells::kGradient, Cells::kRank}) {
      NetworkOptions options = RecollectNetwork();
      options.neurons_x = 6;
      options.neurons_y = 4;
      options.cells = cells;
      const cv::Mat scene = Scene(2, width, 200);
      Encoder encoder(options, width, 200, pool);
      // 65 displacements a row are more than one read of packed bits takes in.
      const Displacements grid{cells == Cells::kGradient ? 65 : 9, 9, 4};
      const DisplacedPatterns patterns = encoder.EncodeDisplaced(View(scene), grid);
      for (int d = 0; d < grid.count(); ++d) {
        const auto pixels = [&](int steps) {
          return static_cast<int>(std::lround(steps * grid.step * width / 640.0));
        };
        const Pixel shift{pixels(d % grid.columns - grid.columns / 2),
                          pixels(d / grid.columns - grid.rows / 2)};
        ASSERT_EQ(patterns.Under(d), encoder.Encode(View(scene), shift)) << width << " " << d;
      }
      // Some of them, and one neuron's at a time.
      const DisplacedImage image = encoder.LookDisplaced(View(scene), grid);
      const DisplacedPatterns some = image.Every(4);
      ASSERT_EQ(some.grid.columns, grid.columns / 4 + 1);
      ASSERT_EQ(some.grid.rows, 3);
      for (int d = 0; d < some.grid.count(); ++d) {
        const int x = 4 * (d % some.grid.columns), y = 4 * (d / some.grid.columns);
        ASSERT_EQ(some.Under(d), patterns.Under(y * grid.columns + x)) << width << " " << d;
      }
      std::vector<std::uint64_t> room;
      for (std::size_t n = 0; n < 24; ++n) {
        ASSERT_TRUE(std::ranges::equal(image.Of(n, room), patterns.Of(n))) << width << " " << n;
      }
    }
  }
}

TEST(Invariant, NeuronsKeepTheirNearestEntryUnderAnyDisplacement) {
  ThreadPool pool(3);
  NetworkOptions options = RecollectNetwork();
  options.neurons_x = 8;
  options.neurons_y = 6;
  Encoder encoder(options, 320, 240, pool);
  Memory memory(options.neurons());
  for (std::uint64_t place = 0; place < 70; ++place) {  // a full block and a tail
    memory.Append(encoder.Encode(View(Scene(place))));
  }
  EntrySet some(memory);
  some.AllowRange(3, 40).AllowRange(50, 69);
  const DisplacedPatterns live = encoder.EncodeDisplaced(View(Scene(99)), encoder.displacements());
  for (const EntrySet* allowed : std::initializer_list<const EntrySet*>{nullptr, &some}) {
    const DisplacedAnswers asked = AskDisplaced(memory, live, pool, {.allowed = allowed});
    for (std::size_t n = 0; n < 48; ++n) {
      int least = 1000, of_answer = 1000, first = -1;
      for (int entry = 0; entry < 70; ++entry) {
        if (allowed && !allowed->Allows(entry)) continue;
        const auto stored = memory.Pattern(entry);
        for (int d = 0; d < 45; ++d) {
          const auto at = static_cast<std::size_t>(d);
          const int distance = std::popcount(live.Of(n)[at] ^ stored[2 * n]) +
                               std::popcount(live.Of(n)[45 + at] ^ stored[2 * n + 1]);
          least = std::min(least, distance);
          if (entry != AnswerEntry(asked.answers[n]) || distance >= of_answer) continue;
          of_answer = distance;
          first = d;
        }
      }
      EXPECT_EQ(AnswerDistance(asked.answers[n]), least) << n;
      EXPECT_EQ(of_answer, least) << n;
      EXPECT_EQ(asked.seen_under[n], first) << n;
    }
  }
}

TEST(Invariant, VotesUnderFarDisplacementsDoNotAddUp) {
  const Displacements grid{3, 1, 16};
  const std::vector<int> labels = {0, 1};
  // Entry 0 gets five votes, all under the left displacement; entry 1 six, three at either end.
  DisplacedAnswers asked;
  for (int n = 0; n < 11; ++n) {
    asked.answers.push_back(MakeAnswer(5, 0, n < 5 ? 0 : 1));
    asked.seen_under.push_back(n < 8 ? 0 : 2);
  }
  const Recollection merged = MergeDisplaced(labels, asked, grid);
  EXPECT_EQ(merged.winner, 0);
  EXPECT_EQ(merged.histogram[0].votes, 5);
  EXPECT_EQ(merged.histogram[1].votes, 3);
  EXPECT_NEAR(merged.confidence, 0.4, 1e-12);
}

TEST(Invariant, TheReferenceIsUntouchedAndBadOptionsAreRefused) {
  EXPECT_FALSE(InvariantEncoder::Wanted({}));
  EXPECT_TRUE(InvariantEncoder::Wanted(RecollectNetwork()));
  EXPECT_EQ(DisplacementsOf({}).count(), 1);
  NetworkOptions options = RecollectNetwork();
  options.shift_step = 0;
  EXPECT_THROW(DisplacementsOf(options), Error);
  options = RecollectNetwork();
  options.contrast_sigma = -1;
  EXPECT_THROW(Synapses(options, 160, 120), Error);
}

}  // namespace
}  // namespace recollect::wnn
