#include "recollect/wnn/explanation.h"

#include <gtest/gtest.h>

#include <numeric>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/wnn/displaced.h"
#include "recollect/wnn/test_scene.h"

namespace recollect::wnn {
namespace {

int HalvesIn(const Explanation& why, const Voters& voters, int from_column, int to_column) {
  int sum = 0;
  for (int y = 0; y < why.rows; ++y) {
    for (int x = from_column; x < to_column; ++x) {
      sum += voters.halves[static_cast<std::size_t>(y * why.columns + x)];
    }
  }
  return sum;
}

struct Learnt {
  explicit Learnt(NetworkOptions network) : options(network) {
    for (std::uint64_t place = 0; place < 12; ++place) {
      memory.Append(encoder.Encode(View(Scene(place))));
    }
  }
  NetworkOptions options;
  ThreadPool pool{2};
  Encoder encoder{options, 320, 240, pool};
  Memory memory{options.neurons()};
};

TEST(Explanation, TellsWhereTheVotersOfEachPlaceAre) {
  NetworkOptions vibgl;
  vibgl.gaussian_synapses = kSynapses;
  NetworkOptions without = RecollectNetwork();
  without.closer_step = 0;
  for (const NetworkOptions& options : {RecollectNetwork(), without, vibgl}) {
    Learnt learnt(options);
    // The left two thirds of one place, the right third of another.
    cv::Mat live = Scene(4).clone();
    Scene(9).colRange(213, 320).copyTo(live.colRange(213, 320));
    const Recollection found =
        RecollectImage(learnt.memory, learnt.encoder, View(live), learnt.pool);
    ASSERT_EQ(found.winner, 4);
    const int runner_up = RunnerUp(ChainRoute(12), found);
    ASSERT_EQ(runner_up, 9);
    const Explanation why = Explain(learnt.memory, learnt.encoder, View(live), found, runner_up);
    EXPECT_EQ(why.columns, options.neurons_x);
    EXPECT_EQ(why.rows, options.neurons_y);
    const int cut = options.neurons_x * 2 / 3;
    for (const Voters* voters : {&why.winner, &why.runner_up}) {
      const int all = std::accumulate(voters->halves.begin(), voters->halves.end(), 0);
      EXPECT_EQ(voters->votes, (all + 1) / 2);
      const int left = HalvesIn(why, *voters, 0, cut);
      EXPECT_GT(voters == &why.winner ? left : all - left, 0.85 * all);
    }
    EXPECT_EQ(why.winner.votes, found.histogram[0].votes);
  }
}

TEST(Explanation, ThereMayBeNoRunnerUp) {
  Learnt learnt(RecollectNetwork());
  Recollection found;
  found.winner = 3;
  found.histogram = {{3, 20}, {4, 9}, {2, 1}};
  EXPECT_EQ(RunnerUp(ChainRoute(12), found), -1);
  const cv::Mat live = Scene(3);
  EXPECT_THROW(Explain(learnt.memory, learnt.encoder, View(live), found, -1), Error);
  found = RecollectImage(learnt.memory, learnt.encoder, View(live), learnt.pool);
  const Explanation why = Explain(learnt.memory, learnt.encoder, View(live), found, -1);
  EXPECT_EQ(why.runner_up.label, -1);
  EXPECT_TRUE(why.runner_up.halves.empty());
}

}  // namespace
}  // namespace recollect::wnn
