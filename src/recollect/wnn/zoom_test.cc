#include "recollect/wnn/zoom.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/wnn/displaced.h"
#include "recollect/wnn/sequence.h"
#include "recollect/wnn/test_scene.h"

namespace recollect::wnn {
namespace {

const Displacements kGrid{33, 17, 4};

std::vector<PartCentre> Centres() {
  const NetworkOptions options = RecollectNetwork();
  ThreadPool pool(1);
  const Encoder encoder(options, 640, 480, pool);
  return PartCentres(encoder.synapses(), encoder.parts());
}

// Parts of a scene that has grown by so many pixels at the window's edge, seen `aside` pixels
// further to a side by walls left and right, the whole turned by 20 and 8 pixels.
Look Seen(const std::vector<PartCentre>& centres, double growth, double aside) {
  const auto steps = [](double pixels, int middle) {
    return static_cast<int>(std::lround(pixels / kGrid.step)) + middle;
  };
  Look look{0, {0}, {100}};
  for (const auto& [x, y] : centres) {
    const int column = steps(20 + aside * std::abs(x) + growth * x, 16);
    look.displacements.push_back(steps(8 + growth * y, 8) * kGrid.columns + column);
    look.votes.push_back(12);
  }
  return look;
}

TEST(Zoom, CentresOfPartsAreSpreadOverTheWindow) {
  const auto centres = Centres();
  ASSERT_EQ(centres.size(), 24U);
  EXPECT_NEAR(centres[0].x, -0.875, 1e-9);
  EXPECT_NEAR(centres[23].x, 0.875, 1e-9);
  EXPECT_NEAR(centres[0].y, -2.0 / 3 * 364 / 640, 1e-9);
  EXPECT_NEAR(centres[12].y, 0, 1e-9);
}

TEST(Zoom, GrowthIsToldFromWalkingFurtherToASide) {
  const auto centres = Centres();
  for (const double growth : {-24.0, -8.0, 0.0, 8.0, 24.0}) {
    for (const double aside : {-12.0, 0.0, 12.0}) {
      Look look = Seen(centres, growth, aside);
      EXPECT_NEAR(ZoomOf(look, centres, kGrid).growth, growth, 2) << growth << " " << aside;
      // Two parts that saw something else.
      look.displacements[3] = 0;
      look.displacements[20] = kGrid.count() - 1;
      const Zoom zoom = ZoomOf(look, centres, kGrid);
      EXPECT_NEAR(zoom.growth, growth, 4) << growth << " " << aside;
      EXPECT_GT(zoom.variance, ZoomOf(Seen(centres, growth, aside), centres, kGrid).variance);
    }
  }
}

// The wall that one walks nearer to is the larger and has more votes: alone it looks like growth.
TEST(Zoom, IsNotThatOfTheNearerWall) {
  const auto centres = Centres();
  for (const double growth : {-8.0, 0.0, 8.0}) {
    Look look = Seen(centres, growth, 12);
    for (std::size_t part = 0; part < centres.size(); ++part) {
      look.votes[part + 1] = centres[part].x < 0 ? 20 : 6;
    }
    EXPECT_NEAR(ZoomOf(look, centres, kGrid).growth, growth, 2) << growth;
  }
}

// Of the middle one of five places.
double SteadyAmong(const std::vector<Zoom>& five) {
  std::vector<ZoomAlong> along;
  for (int i = -2; i <= 2; ++i) along.push_back({1.0 * i, five[static_cast<std::size_t>(2 + i)]});
  return Steady(along, five[1], five[2], five[3]);
}

TEST(Zoom, NothingIsKnownWithoutVotes) {
  const auto centres = Centres();
  Look look = Seen(centres, 8, 0);
  std::fill(look.votes.begin(), look.votes.end(), 0);
  const Zoom none = ZoomOf(look, centres, kGrid);
  EXPECT_TRUE(std::isinf(none.variance));
  EXPECT_EQ(SteadyAmong({none, {8, 1}, none, {-8, 1}, none}), 1);
  EXPECT_EQ(SteadyAmong({none, none, {9, 1}, {-8, 1}, none}), 1);
  EXPECT_LT(SteadyAmong({none, {17, 1}, {9, 1}, {1, 1}, none}), 1);
  look.votes.pop_back();
  EXPECT_THROW(ZoomOf(look, centres, kGrid), Error);
}

TEST(Zoom, CountsByWhatPlacesGrow) {
  const auto steady = [](double here, double a_place, double variance = 0.01) {
    const auto at = [&](int place) { return Zoom{here - place * a_place, variance}; };
    return SteadyAmong({at(-2), at(-1), at(0), at(1), at(2)});
  };
  EXPECT_EQ(steady(0, 20), 1);
  EXPECT_NEAR(steady(56.6, 20), 0.5, 0.01);
  EXPECT_NEAR(steady(-40, 20), steady(40, 20), 1e-9);
  EXPECT_NEAR(steady(40, -20), steady(40, 20), 1e-9);  // of a camera that looks back
  EXPECT_GT(steady(40, 60), 0.85);                     // these lie further apart
  EXPECT_GT(steady(40, 20, 100), steady(40, 20));
  // Of a camera that looks sideways: no place grows, and what is measured is chance.
  EXPECT_GT(steady(8, 0.3, 60), 0.8);
}

// A car that waited, or key frames too far apart for a line.
TEST(Zoom, OneSpotTellsNothing) {
  const Zoom grown = {20, 4};
  const std::vector<ZoomAlong> here = {{0, grown}}, waited = {{0, grown}, {0, grown}, {0, grown}};
  EXPECT_EQ(Steady(here, {30, 4}, grown, {10, 4}), 1);
  EXPECT_EQ(Steady(waited, grown, grown, grown), 1);
  EXPECT_EQ(Steady({}, grown, grown, grown), 1);
}

// One label by itself may see growth that is not there, or miss it.
TEST(Zoom, NeighboursHaveTheirSay) {
  const std::vector<Zoom> clear = {{24, 4}, {12, 4}, {0, 4}, {-12, 4}, {-24, 4}};
  const std::vector<Zoom> off = {{24, 4}, {12, 4}, {10, 20}, {-12, 4}, {-24, 4}};
  EXPECT_NEAR(SteadyAmong(clear), 1, 1e-9);
  EXPECT_GT(SteadyAmong(off), 0.95);
  const std::vector<Zoom> on = {{34, 4}, {22, 4}, {0, 20}, {-2, 4}, {-14, 4}};
  EXPECT_LT(SteadyAmong(on), 0.997);
  // So have those of another lap, wherever they lie.
  std::vector<ZoomAlong> both = {{-1, {22, 4}}, {0, {0, 20}}, {1, {-2, 4}}};
  const double alone = Steady(both, {22, 4}, {0, 20}, {-2, 4});
  both.push_back({0.3, {-3.6, 1}});
  both.push_back({-0.5, {6, 1}});
  EXPECT_GT(Steady(both, {22, 4}, {0, 20}, {-2, 4}), alone);
}

TEST(Zoom, TellsWhichViewAlongARoadIsTheNearest) {
  // Views of two scenes, each five parts in a hundred nearer than the one before.
  constexpr int kViews = 7;
  ThreadPool pool(2);
  Encoder encoder(RecollectNetwork(), 320, 240, pool);
  Memory memory(RecollectNetwork().neurons());
  const auto view = [](std::uint64_t scene, int i) {
    const double zoom = 1 + 0.05 * i;
    const cv::Mat motion =
        (cv::Mat_<double>(2, 3) << zoom, 0, (1 - zoom) * 160, 0, zoom, (1 - zoom) * 91);
    cv::Mat moved;
    cv::warpAffine(Scene(scene), moved, motion, {320, 240}, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    return moved;
  };
  for (const std::uint64_t scene : {1, 2}) {
    for (int i = 0; i < kViews; ++i) memory.Append(encoder.Encode(View(view(scene, i))));
  }
  for (int i = 2; i < kViews - 2; ++i) {
    const Recollection found = RecollectImage(memory, encoder, View(view(2, i)), pool);
    const auto steadiness = Steadiness(ChainRoute(2 * kViews), found.histogram);
    std::vector<double> steady(2 * kViews, 0);
    for (std::size_t k = 0; k < steadiness.size(); ++k) {
      steady[static_cast<std::size_t>(found.histogram[k].label)] = steadiness[k];
    }
    const auto own = static_cast<std::size_t>(kViews + i);
    EXPECT_GT(steady[own], 0.8) << i;
    EXPECT_LT(steady[own - 1], steady[own]) << i;
    EXPECT_LT(steady[own + 1], steady[own]) << i;
  }
}

TEST(Zoom, IsNotToldWhereItIsNotWanted) {
  ThreadPool pool(2);
  NetworkOptions options = RecollectNetwork();
  for (const bool growth : {true, false}) {
    options.growth = growth;
    Encoder encoder(options, 320, 240, pool);
    Memory memory(options.neurons());
    for (std::uint64_t scene = 0; scene < 3; ++scene) {
      memory.Append(encoder.Encode(View(Scene(scene))));
    }
    const auto found = RecollectImage(memory, encoder, View(Scene(1)), pool).histogram;
    EXPECT_EQ(std::isinf(found.at(0).zoom.variance), !growth);
  }
}

TEST(Zoom, DecidesBetweenNeighboursOnly) {
  const Route route = ChainRoute(10);
  // The place ahead looks bigger, and has a few more votes for that.
  const std::vector<LabelVotes> histogram = {
      {5, 60, {16, 1}}, {4, 55, {-2, 1}}, {6, 20, {30, 1}}, {3, 40, {-18, 1}}, {9, 30, {0, 1}}};
  const std::vector<double> belief = {0, 0, 0, 0.1, 0.4, 0.5, 0, 0, 0, 0};
  EXPECT_EQ(Supported(route, histogram), 4);
  EXPECT_EQ(MostLikely(route, belief, histogram).place, 4);
  std::vector<LabelVotes> unknown = histogram;
  for (LabelVotes& one : unknown) one.zoom = {};
  EXPECT_EQ(Supported(route, unknown), 5);
  EXPECT_EQ(MostLikely(route, belief, unknown).place, 5);
  const auto with = Likelihood({}, route, {histogram, 100, {}, {}});
  const auto without = Likelihood({}, route, {unknown, 100, {}, {}});
  EXPECT_NEAR(with[5], SteadyAmong({{-18, 1}, {-2, 1}, {16, 1}, {30, 1}, {}}) * without[5], 1e-12);
  EXPECT_LT(with[5], 0.98 * without[5]);
  EXPECT_NEAR(with[9], without[9], 1e-12);
  EXPECT_NEAR(with[0], without[0], 1e-12);
}

TEST(Route, WhatIsBelievedDecidesBetweenPlacesThatStandOutAlike) {
  const Route route = ChainRoute(10);
  const std::vector<LabelVotes> histogram = {{5, 61}, {4, 60}, {3, 90}, {8, 99}};
  EXPECT_EQ(Outstanding(route, 5, histogram), 5);
  EXPECT_EQ(Outstanding(route, 6, histogram), 5);
  EXPECT_EQ(Outstanding(route, 1, histogram), 1);
  std::vector<double> belief(10, 0.01);
  belief[4] = 0.5;
  EXPECT_EQ(Outstanding(route, 5, histogram, belief), 4);
  EXPECT_EQ(Outstanding(route, 4, histogram, belief), 3);  // many more votes weigh more
}

TEST(Zoom, NoPlaceAmongThoseLookedAtIsLeftOut) {
  ThreadPool pool(2);
  Encoder encoder(RecollectNetwork(), 320, 240, pool);
  Memory memory(RecollectNetwork().neurons());
  for (std::uint64_t place = 0; place < 120; ++place) {
    memory.Append(encoder.Encode(View(Scene(place))));
  }
  int stretches = 1;
  for (const std::uint64_t live : {200, 201, 202}) {
    const auto looks = RecollectImage(memory, encoder, View(Scene(live)), pool).second_look;
    for (std::size_t i = 1; i < looks.size(); ++i) {
      const int apart = looks[i].label - looks[i - 1].label;
      EXPECT_TRUE(apart == 1 || apart > 5) << looks[i].label;
      stretches += apart > 1;
    }
  }
  EXPECT_GT(stretches, 3);
}

}  // namespace
}  // namespace recollect::wnn
