#include "recollect/cnn/training_data.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <opencv2/core.hpp>
#include <set>

#include "recollect/core/error.h"
#include "recollect/core/random.h"

namespace recollect::cnn {
namespace {

constexpr double kBlockMetres = 40;

using Block = std::array<int, 3>;

Block BlockOf(const StoredFrame& frame) {
  Block block;
  for (int i = 0; i < 3; ++i) {
    block[static_cast<std::size_t>(i)] =
        static_cast<int>(std::floor(frame.world_from_camera.translation()[i] / kBlockMetres));
  }
  return block;
}

// Blocks whose frames are validated, drawn until they hold the share of all frames.
std::set<Block> DrawBlocks(const std::vector<StoredFrame>& frames, double share,
                           std::uint64_t seed) {
  std::map<Block, int> sizes;
  for (const StoredFrame& frame : frames) ++sizes[BlockOf(frame)];
  std::vector<std::pair<std::uint64_t, Block>> drawn;
  for (const auto& [block, size] : sizes) drawn.emplace_back(SubSeed(seed, drawn.size()), block);
  std::sort(drawn.begin(), drawn.end());
  std::set<Block> chosen;
  double count = 0;
  for (const auto& [number, block] : drawn) {
    if (count >= share * static_cast<double>(frames.size())) break;
    chosen.insert(block);
    count += sizes[block];
  }
  return chosen;
}

std::vector<std::size_t> Every(std::size_t count, std::size_t at_most) {
  std::vector<std::size_t> numbers;
  const std::size_t taken = std::min(count, at_most);
  for (std::size_t i = 0; i < taken; ++i) numbers.push_back(i * count / taken);
  return numbers;
}

}  // namespace

std::pair<PairData, PairData> SplitRoad(const PairData& all, double share, std::uint64_t seed) {
  const std::set<Block> chosen = DrawBlocks(all.frames, share, SubSeed(seed, 4));
  // The frames' pixels are shared by both results.
  PairData train{all.crop, all.camera, all.frames, {}}, valid = train;
  for (const Pair& pair : all.pairs) {
    const bool live = chosen.contains(BlockOf(all.frames[pair.live]));
    const bool key = chosen.contains(BlockOf(all.frames[pair.key]));
    if (live == key) (live ? valid : train).pairs.push_back(pair);
  }
  Require(!train.pairs.empty() && !valid.pairs.empty(), "validation share",
          "leaves no pairs to train or to validate on", "use a longer road or validation laps");
  return {std::move(train), std::move(valid)};
}

TrainingData LoadTrainingData(std::span<const Lap> laps, std::span<const Lap> valid,
                              const TrainOptions& options, ThreadPool& pool,
                              const ProgressSink& progress) {
  Require(!laps.empty(), "laps", "there are none");
  const PinholeCamera& camera = laps.front().camera.left;
  const Crop crop = DefaultCrop(options.network, camera.width, camera.height);
  TrainingData data;
  for (const Lap& lap : laps) data.laps.push_back(lap.name);
  PairOptions train_pairs = options.pairs;
  train_pairs.depth_from_motion = true;  // the losses are over points of the live image
  data.train = LoadPairs(laps, laps, crop, train_pairs, pool, progress);
  const bool any_depth =
      std::any_of(data.train.frames.begin(), data.train.frames.end(), [](const StoredFrame& frame) {
        return !frame.depth.empty() && cv::countNonZero(frame.depth > 0) > 0;
      });
  Require(any_depth, laps.front().folder.string(),
          "has no depth images, and its images move too little to tell depth from");
  if (valid.empty()) {
    std::tie(data.train, data.valid) =
        SplitRoad(data.train, options.validation_share, options.seed);
    data.validated_on = fmt::format("{:.0f} % of the road, kept out of the training",
                                    100 * options.validation_share);
  } else {
    data.valid = LoadPairs(valid, laps, crop, options.pairs, pool, progress);
    data.validated_on = "live frames of";
    for (const Lap& lap : valid) data.validated_on += " " + lap.name;
  }
  data.quick_valid =
      Every(data.valid.pairs.size(), static_cast<std::size_t>(options.validation_pairs));
  return data;
}

}  // namespace recollect::cnn
