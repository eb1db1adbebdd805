#include "recollect/wnn/sequence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/core/random.h"
#include "recollect/wnn/calibration.h"
#include "recollect/wnn/precision.h"

namespace recollect::wnn {
namespace {

constexpr int kPlaces = 60;
constexpr int kNeurons = 100;

// A committee that knows the truth half of the time.
std::vector<LabelVotes> Votes(int truth, Random& random, int places = kPlaces) {
  std::vector<int> votes(static_cast<std::size_t>(places), 1);
  const bool right = random.Uniform() < 0.5;
  const auto place = right ? truth : static_cast<int>(random.Index(places));
  votes[static_cast<std::size_t>(place)] += 25;
  votes[static_cast<std::size_t>(truth)] += 4;
  std::vector<LabelVotes> histogram;
  for (int i = 0; i < places; ++i) histogram.push_back({i, votes[static_cast<std::size_t>(i)]});
  return histogram;
}

double Sum(const std::vector<double>& belief) {
  return std::accumulate(belief.begin(), belief.end(), 0.0);
}

// Share of right answers, within one, from the 10th image on, along drives of so many images a
// place.
double ShareRight(const SequenceOptions& options, double images_a_place) {
  const Route route = ChainRoute(kPlaces);
  int right = 0, count = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto sequence = MakeSequence(options, route);
    Random random(seed);
    for (int image = 0; image < 50 * images_a_place; ++image) {
      const int truth = 4 + static_cast<int>(image / images_a_place);
      const auto histogram = Votes(truth, random);
      const auto belief = sequence->Update({histogram, kNeurons, {}, {}});
      EXPECT_NEAR(Sum(belief), 1, 1e-9);
      if (image < 9) continue;
      right += route.WithinOne(truth, MostLikely(route, belief).place);
      ++count;
    }
  }
  return static_cast<double>(right) / count;
}

TEST(Sequence, TheFilterMendsWhatSingleImagesGetWrongAtAnySpeed) {
  const double alone = ShareRight({.filter = Filter::kNone}, 1);
  EXPECT_LT(alone, 0.75);
  for (const double images_a_place : {0.5, 1.0, 3.0}) {
    for (const int history : {0, 10}) {
      EXPECT_GT(ShareRight({.filter = Filter::kBayes, .history = history}, images_a_place), 0.85)
          << images_a_place << " images a place, history " << history;
    }
  }
}

TEST(Sequence, TheFilterFindsItselfAgainElsewhere) {
  const Route route = ChainRoute(kPlaces);
  const auto filter = MakeSequence({.filter = Filter::kBayes, .history = 0}, route);
  Random random(4);
  PlaceBelief found;
  for (int image = 0; image < 30; ++image) {
    const int truth = image < 15 ? image : 30 + image;
    const auto histogram = Votes(truth, random);
    found = MostLikely(route, filter->Update({histogram, kNeurons, {}, {}}));
  }
  EXPECT_TRUE(route.WithinOne(found.place, 59));
}

double BeliefNear(const Route& route, const std::vector<double>& belief, int truth) {
  double sum = 0;
  for (int place = 0; place < route.places(); ++place) {
    if (route.WithinOne(truth, place)) sum += belief[static_cast<std::size_t>(place)];
  }
  return sum;
}

TEST(Sequence, ManyImagesAPlaceDoNotHurryTheFilterOn) {
  const Route route = ChainRoute(kPlaces);
  for (const int history : {0, 10}) {
    double near = 0;
    int count = 0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const auto filter = MakeSequence({.filter = Filter::kBayes, .history = history}, route);
      Random random(seed);
      for (int image = 0; image < 8 * 50; ++image) {
        const int truth = 4 + image / 8;
        const auto belief = filter->Update({Votes(truth, random), kNeurons, {}, {}});
        if (image < 9) continue;
        near += BeliefNear(route, belief, truth);
        ++count;
      }
    }
    EXPECT_GT(near / count, history == 0 ? 0.96 : 0.94) << "history " << history;
  }
}

TEST(Sequence, BoundedHistoryForgetsPlacesAndRemembersSpeed) {
  const Route route = ChainRoute(kPlaces);
  const SequenceOptions options{.filter = Filter::kBayes, .history = 5};
  const auto known = MakeSequence(options, route), elsewhere = MakeSequence(options, route);
  const auto fresh = MakeSequence(options, route);
  Random random(5);
  std::vector<double> of_known, of_elsewhere, of_fresh;
  const std::vector<LabelVotes> nothing = {{0, 1}};
  for (int image = 0; image < 30; ++image) {
    auto histogram = Votes(20 + image, random);
    auto far = image < 25 ? Votes(5 + image, random) : histogram;
    if (image >= 28) histogram = far = nothing;
    of_known = known->Update({histogram, kNeurons, {}, {}});
    of_elsewhere = elsewhere->Update({far, kNeurons, {}, {}});
    if (image >= 25) of_fresh = fresh->Update({histogram, kNeurons, {}, {}});
  }
  for (std::size_t i = 0; i < of_known.size(); ++i) {
    EXPECT_NEAR(of_known[i], of_elsewhere[i], 0.05) << i;
  }
  EXPECT_GT(BeliefNear(route, of_known, 49), BeliefNear(route, of_fresh, 49) + 0.1);
  known->Reset();
  EXPECT_EQ(known->Update({nothing, kNeurons, {}, {}}),
            MakeSequence(options, route)->Update({nothing, kNeurons, {}, {}}));
}

TEST(Sequence, OdometryTellsTwinsApart) {
  // Places 10 and 40 look alike, and so does all between; 5 is known.
  const Route route = ChainRoute(kPlaces);
  const auto filter = MakeSequence({.filter = Filter::kBayes, .history = 0}, route);
  const std::vector<LabelVotes> known = {{5, 90}}, twins = {{10, 45}, {40, 45}};
  filter->Update({known, kNeurons, {}, {}});
  const auto near = filter->Update({twins, kNeurons, {}, 5.0});
  EXPECT_EQ(MostLikely(route, near).place, 10);
  filter->Reset();
  filter->Update({known, kNeurons, {}, {}});
  const auto far = filter->Update({twins, kNeurons, {}, 35.0});
  EXPECT_EQ(MostLikely(route, far).place, 40);
}

TEST(Sequence, LapsBesideEachOtherSupportEachOther) {
  // Two laps of 10; place i and 10 + i are the same.
  Route route = ChainRoute(20);
  route.next[9] = route.before[10] = -1;
  for (int i = 0; i < 10; ++i) {
    route.beside[static_cast<std::size_t>(i)] = {10 + i};
    route.beside[static_cast<std::size_t>(10 + i)] = {i};
  }
  const std::vector<LabelVotes> votes = {{2, 30}, {7, 20}, {17, 25}};
  EXPECT_EQ(Supported(route, votes), 17);
  EXPECT_TRUE(route.WithinOne(3, 14));
  EXPECT_FALSE(route.WithinOne(3, 15));
  const auto filter = MakeSequence({.filter = Filter::kBayes}, route);
  EXPECT_EQ(MostLikely(route, filter->Update({votes, kNeurons, {}, {}})).place, 17);
}

TEST(Sequence, SabglWarpsAlongTheRoute) {
  const Route route = ChainRoute(kPlaces);
  const auto sabgl = MakeSequence({.filter = Filter::kSabgl, .history = 5}, route);
  Random random(6);
  int right = 0, alone = 0;
  for (int image = 0; image < 50; ++image) {
    std::vector<float> distances(kPlaces);
    for (float& d : distances) d = static_cast<float>(random.Uniform(30, 60));
    for (int k = -2; k <= 2; ++k) {
      if (image + k < 0) continue;
      distances[static_cast<std::size_t>(image + k)] = static_cast<float>(31 + 2 * std::abs(k));
    }
    const auto belief = sabgl->Update({{}, kNeurons, distances, {}});
    EXPECT_NEAR(Sum(belief), 1, 1e-9);
    const auto nearest = std::min_element(distances.begin(), distances.end());
    alone += std::abs(static_cast<int>(nearest - distances.begin()) - image) <= 1;
    if (image >= 5) right += std::abs(MostLikely(route, belief).place - image) <= 1;
  }
  EXPECT_LT(alone, 30);
  EXPECT_GE(right, 43);
  EXPECT_THROW(sabgl->Update({}), Error);
}

TEST(Sequence, MeanDistancesAreThoseOfThePatterns) {
  ThreadPool pool(2);
  Memory memory(10);
  std::vector<std::uint64_t> zero(20, 0), some(20, 0xff), all(20, ~std::uint64_t{0});
  for (const auto& pattern : {zero, some, all}) memory.Append(pattern);
  const auto distances = MeanDistances(memory, some, pool);
  EXPECT_EQ(distances, (std::vector<float>{16, 0, 112}));
}

TEST(Sequence, BadOptionsAreRefused) {
  EXPECT_THROW(MakeSequence({.history = -1}, ChainRoute(3)), Error);
  EXPECT_THROW(MakeSequence({.filter = Filter::kSabgl, .history = 0}, ChainRoute(3)), Error);
  EXPECT_THROW(MakeSequence({}, ChainRoute(0)), Error);
}

TEST(Calibration, ProbabilitiesAreThoseOfNewImages) {
  const Route route = ChainRoute(kPlaces);
  Random random(7);
  const auto make = [&](int count) {
    std::vector<Trial> trials;
    for (int i = 0; i < count; ++i) {
      const auto truth = static_cast<int>(random.Index(kPlaces));
      Trial trial{Votes(truth, random), kNeurons, {}, {}};
      for (int p = 0; p < kPlaces; ++p) {
        if (route.WithinOne(truth, p)) trial.right.push_back(p);
      }
      trials.push_back(trial);
      std::vector<LabelVotes> flat;  // from nowhere: all alike
      for (int p = 0; p < kPlaces; ++p) flat.push_back({p, 1 + static_cast<int>(random.Index(4))});
      trials.push_back({flat, kNeurons, {}, {}});
    }
    return trials;
  };
  const Calibration calibration = Calibrate(route, make(500));
  double said = 0, was = 0;
  int strangers = 0;
  const double threshold = ThresholdFor(calibration, 0.5);
  for (const Trial& trial : make(500)) {
    const Judged judged = Judge(calibration, route, trial.histogram, trial.neurons);
    if (trial.right.empty()) {
      strangers += judged.probability >= threshold;
      continue;
    }
    said += judged.probability;
    was += std::find(trial.right.begin(), trial.right.end(), judged.place) != trial.right.end();
  }
  EXPECT_NEAR(said / 500, was / 500, 0.05);
  EXPECT_LT(strangers, 250);
  EXPECT_LT(threshold, 1);
  EXPECT_EQ(ThresholdFor(calibration, 0.9999), 1);
  EXPECT_THROW(Calibrate(route, {}), Error);
}

TEST(Calibration, ChangedCopiesOfOneLapCountLess) {
  const Route route = ChainRoute(kPlaces);
  // Of answers as clear as can be, half are wrong.
  const auto make = [&](bool copy) {
    std::vector<Trial> trials;
    for (int i = 0; i < 200; ++i) {
      const int truth = i % kPlaces, told = i % 2 == 0 ? truth : (truth + 30) % kPlaces;
      Trial trial{{{told, 60}}, kNeurons, {}, {}, truth, copy};
      for (int p = 0; p < kPlaces; ++p) {
        if (route.WithinOne(truth, p)) trial.right.push_back(p);
      }
      trials.push_back(trial);
    }
    return Calibrate(route, trials);
  };
  const std::vector<LabelVotes> clear = {{7, 60}};
  const auto sure = [&](const Calibration& calibration) {
    return Judge(calibration, route, clear, kNeurons).probability;
  };
  EXPECT_GT(sure({}), 0.99);
  EXPECT_LT(sure(make(true)), 0.9);
  EXPECT_GT(sure(make(true)), sure(make(false)) + 0.1);
  EXPECT_NEAR(sure(make(false)), 0.5, 0.05);
}

// However well all trials go, who wants 99 % keeps nothing that is more than 4 % unsure.
TEST(Calibration, EasyTrialsProveNoLowThreshold) {
  const Route route = ChainRoute(kPlaces);
  std::vector<Trial> trials;
  for (int i = 0; i < 400; ++i) {
    const int truth = i % kPlaces;
    const std::vector<LabelVotes> dull = {{truth, 8 + i % 6}, {(truth + 30) % kPlaces, 7}};
    trials.push_back({dull, kNeurons, {truth}, {truth}, truth});
    trials.push_back({{{truth, 7}, {(truth + 30) % kPlaces, 7}}, kNeurons, {}, {}});  // nowhere
  }
  const Calibration calibration = Calibrate(route, trials);
  EXPECT_DOUBLE_EQ(ThresholdFor(calibration, 0.99), 0.96);
}

TEST(Calibration, ARivalElsewhereAndFewVotesMakeUnsure) {
  const Route route = ChainRoute(kPlaces);
  const auto sure = [&](const std::vector<LabelVotes>& votes) {
    const Judged judged = Judge({}, route, votes, kNeurons);
    EXPECT_EQ(judged.place, 7);
    return judged.probability;
  };
  const double clear = sure({{7, 40}, {30, 5}});
  EXPECT_GT(clear, 0.95);
  EXPECT_NEAR(sure({{7, 40}, {6, 35}, {30, 5}}), clear, 0.03);  // beside it: no rival
  EXPECT_LT(sure({{7, 40}, {30, 38}}), clear - 0.05);
  EXPECT_LT(sure({{7, 8}, {30, 1}}), clear - 0.05);
  EXPECT_EQ(Judge({}, route, {}, kNeurons).place, -1);
}

TEST(Calibration, ImagesThatGoWrongTogetherTellLessInASequence) {
  const Route route = ChainRoute(kPlaces);
  // One image in three speaks for a place 20 further on; eight in a row, or any of them.
  const auto fit = [&](bool together) {
    Random random(8);
    std::vector<Trial> trials;
    for (int lap = 0; lap < 6; ++lap) {
      for (int i = 0; i < kPlaces; ++i) {
        const bool wrong = together ? i / 8 % 3 == 2 : random.Uniform() < 1.0 / 3;
        Trial trial{Votes(wrong ? (i + 20) % kPlaces : i, random), kNeurons, {}, {i}, i};
        for (int p = 0; p < kPlaces; ++p) {
          if (route.WithinOne(i, p)) trial.right.push_back(p);
        }
        trials.push_back(trial);
      }
    }
    return Calibrate(route, trials);
  };
  const Calibration together = fit(true), apart = fit(false);
  EXPECT_LT(together.sequence.trust + together.sequence.sharpness,
            apart.sequence.trust + apart.sequence.sharpness);
  EXPECT_GT(together.sequence.trust, 0);
}

TEST(Precision, CurveOfAKnownRanking) {
  const std::vector<double> scores = {0.9, 0.8, 0.7, 0.6};
  const PrecisionCurve curve = MakePrecisionCurve(scores, {true, true, false, true});
  EXPECT_NEAR(curve.recall_at_100_precision, 0.5, 1e-12);
  ASSERT_EQ(curve.points.size(), 4u);
  EXPECT_NEAR(curve.points.back().precision, 0.75, 1e-12);
  EXPECT_NEAR(curve.auc, 0.25 + 0.25 + 0.25 * (2.0 / 3 + 0.75) / 2, 1e-12);
  EXPECT_THROW(MakePrecisionCurve({}, {}), Error);
}

}  // namespace
}  // namespace recollect::wnn
