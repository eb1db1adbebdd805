#include "recollect/dataset/pairing.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <numbers>

#include "recollect/dataset/reader.h"

namespace recollect {
namespace {

TEST(PairsWithin, CountsEveryPairOfTheTorcsLaps) {
  const std::filesystem::path data = RECOLLECT_SHARED_DATA "/torcs-wheel";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << data << " is missing";
  const std::vector<Lap> laps = ReadLaps(data);
  ASSERT_EQ(laps.size(), 4u);
  std::size_t pairs = 0, identical = 0;
  for (int live = 0; live < 3; ++live) {
    for (int key = 0; key < 3; ++key) {
      for (const FramePair& pair : PairsWithin(laps[live], laps[key], 5, std::numbers::pi / 2)) {
        ++pairs;
        if (live == key && pair.live == pair.key) ++identical;
      }
    }
  }
  EXPECT_EQ(pairs, 38512u);
  EXPECT_EQ(identical, 1320u);
}

}  // namespace
}  // namespace recollect
