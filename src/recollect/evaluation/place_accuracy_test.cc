#include "recollect/evaluation/place_accuracy.h"

#include <gtest/gtest.h>

#include <limits>

#include "recollect/core/error.h"
#include "recollect/core/files.h"
#include "recollect/core/parallel.h"
#include "recollect/testing/scratch_folder.h"
#include "recollect/testing/street.h"

namespace recollect {
namespace {

namespace fs = std::filesystem;
constexpr int kNever = std::numeric_limits<int>::max();

// Five live images show places 0, 0, 1, 1, 2.
TEST(PlaceAccuracy, CountsPlacesAndImages) {
  const std::vector<int> truths = {0, 0, 1, 1, 2}, answers = {0, 2, 0, 2, 9};
  EXPECT_EQ(PlacesOff(answers, truths), (std::vector<int>{0, 2, 1, 1, 7}));
  EXPECT_EQ(ImagesOff(answers, truths), (std::vector<int>{0, 3, 1, 1, kNever}));
}

TEST(PlaceAccuracy, OfAStreetDrivenTwiceIsThatOfItsPoses) {
  const testing::ScratchFolder folder;
  const std::vector<Lap> laps = {
      testing::DriveStreet(folder / "a", {.length_m = 30, .seed = 1}),
      testing::DriveStreet(folder / "b", {.length_m = 30, .lateral_m = 0.4, .seed = 2})};
  const std::vector<Lap> live = {
      testing::DriveStreet(folder / "c", {.length_m = 20, .lateral_m = 0.2, .seed = 3})};
  const PlaceTask task = PlacesByNearest(laps, live, 5);
  EXPECT_EQ(task.places, 6);
  ASSERT_EQ(task.learnt.size(), 2u);
  EXPECT_EQ(task.learnt[1].labels, (std::vector<int>{0, 1, 2, 3, 4, 5}));
  ASSERT_EQ(task.live.labels.size(), 20u);
  EXPECT_EQ(task.live.labels[7], 1);  // 7 m along, places at 5 and 10 m
  EXPECT_EQ(task.live.labels[8], 2);

  ThreadPool pool(2);
  wnn::NetworkOptions network = wnn::RecollectNetwork();
  const auto off =
      PlacesOff(AnswerPlaces(network, task.learnt, task.live, 1, pool), task.live.labels);
  EXPECT_GE(std::count(off.begin(), off.end(), 0), 12);
  EXPECT_THROW(AnswerPlaces(network, {}, task.live, 1, pool), Error);
}

TEST(ReadRegistration, HeadsWhereTheDriveGoes) {
  const testing::ScratchFolder folder;
  const fs::path file = folder / "registration.txt";
  AtomicWrite(file, "# x y z\n0 0 0\n0 2 0\n-3 2 0\n");
  const Lap lap = ReadRegistration(file);
  ASSERT_EQ(lap.frames.size(), 3u);
  EXPECT_LT((Heading(lap, 0) - Eigen::Vector3d(0, 1, 0)).norm(), 1e-12);
  EXPECT_LT((Heading(lap, 1) - Eigen::Vector3d(-1, 0, 0)).norm(), 1e-12);
  EXPECT_LT((Heading(lap, 2) - Eigen::Vector3d(-1, 0, 0)).norm(), 1e-12);
  AtomicWrite(file, "1 2 3\n4 5\n");
  EXPECT_THROW(ReadRegistration(file), Error);
}

}  // namespace
}  // namespace recollect
