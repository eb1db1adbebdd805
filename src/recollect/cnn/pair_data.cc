#include "recollect/cnn/pair_data.h"

#include <cmath>
#include <filesystem>
#include <map>
#include <utility>

#include "recollect/core/error.h"
#include "recollect/dataset/image.h"
#include "recollect/dataset/pairing.h"
#include "recollect/dataset/sampling.h"
#include "recollect/depth/motion.h"

namespace recollect::cnn {
namespace {

// Of every step-th crop pixel the depth at the nearest pixel of the depth image.
cv::Mat SampleDepth(const cv::Mat& depth, const PinholeCamera& depth_camera,
                    const PinholeCamera& crop_camera) {
  const PinholeCamera grid = crop_camera.Subsampled(kDepthStep);
  cv::Mat out(grid.height, grid.width, CV_32F);
  for (int v = 0; v < grid.height; ++v) {
    for (int u = 0; u < grid.width; ++u) {
      const Eigen::Vector2d at = depth_camera.Project(grid.Unproject(u, v, 1));
      out.at<float>(v, u) = depth_camera.Contains(at)
                                ? depth.at<float>(static_cast<int>(std::lround(at.y())),
                                                  static_cast<int>(std::lround(at.x())))
                                : 0.F;
    }
  }
  return out;
}

// The frame nearest in the drive that was taken at least a metre away; `index` where there is none.
std::size_t Neighbour(const Lap& lap, std::size_t index) {
  constexpr double kApart = 1;
  constexpr std::size_t kReach = 10;
  const Eigen::Vector3d here = lap.WorldFromCamera(index).translation();
  const auto apart = [&](std::size_t other) {
    return (lap.WorldFromCamera(other).translation() - here).norm() >= kApart;
  };
  for (std::size_t step = 1; step <= kReach; ++step) {
    if (step <= index && apart(index - step)) return index - step;
    if (index + step < lap.frames.size() && apart(index + step)) return index + step;
  }
  return index;
}

cv::Mat DepthByMotion(const Lap& lap, std::size_t index, const Crop& crop,
                      const PinholeCamera& crop_camera, const cv::Mat& image) {
  const std::size_t other = Neighbour(lap, index);
  if (other == index) return {};
  const cv::Mat other_image =
      crop.Apply(ReadColour(lap.frames[other].left), lap.frames[other].left.string());
  const SE3 other_from_image = lap.WorldFromCamera(other).Inverse() * lap.WorldFromCamera(index);
  return SampleDepth(DepthFromMotion(image, other_image, other_from_image, crop_camera),
                     crop_camera, crop_camera);
}

StoredFrame LoadFrame(const Lap& lap, std::size_t index, const Crop& crop,
                      const PinholeCamera& crop_camera, bool depth_from_motion) {
  const Frame& frame = lap.frames[index];
  Require(!frame.left.empty(), lap.folder.string(), "has no images");
  StoredFrame stored;
  stored.image = crop.Apply(ReadColour(frame.left), frame.left.string());
  stored.world_from_camera = lap.WorldFromCamera(index);
  if (!frame.depth.empty()) {
    const cv::Mat depth = ReadDepth(frame.depth, lap.depth_unit);
    const PinholeCamera depth_camera =
        DepthCamera(lap.camera.left, depth.cols, depth.rows, frame.depth.string());
    stored.depth = SampleDepth(depth, depth_camera, crop_camera);
  } else if (depth_from_motion) {
    stored.depth = DepthByMotion(lap, index, crop, crop_camera, stored.image);
  }
  return stored;
}

// Identity of a frame among several laps; the same folder given twice is the same lap.
using FrameId = std::pair<const Lap*, std::size_t>;

bool SameFrame(const Lap& live, const Lap& key, const FramePair& pair) {
  return live.frames[pair.live].left == key.frames[pair.key].left;
}

}  // namespace

PairData LoadPairs(std::span<const Lap> live, std::span<const Lap> key, const Crop& crop,
                   const PairOptions& options, ThreadPool& pool, const ProgressSink& progress) {
  Require(!live.empty() && !key.empty(), "laps", "there are none");
  PairData data;
  data.crop = crop;
  data.camera = crop.Apply(live.front().camera.left);
  for (const auto& laps : {live, key}) {
    for (const Lap& lap : laps) {
      Require(crop.Apply(lap.camera.left) == data.camera, lap.folder.string(),
              fmt::format("has another camera than {}", live.front().folder.string()));
    }
  }

  std::map<std::filesystem::path, std::size_t> numbers;  // of the frames, by image file
  std::vector<FrameId> wanted;
  const auto number = [&](const Lap& lap, std::size_t frame) {
    const auto [at, is_new] = numbers.try_emplace(lap.frames[frame].left, wanted.size());
    if (is_new) wanted.emplace_back(&lap, frame);
    return at->second;
  };
  std::vector<Lap> thinned;
  if (options.key_spacing_m > 0) {
    for (const Lap& lap : key)
      thinned.push_back(Subset(lap, SampleFrames(lap, options.key_spacing_m)));
    key = thinned;
  }
  for (const Lap& live_lap : live) {
    for (const Lap& key_lap : key) {
      for (const FramePair& pair :
           PairsWithin(live_lap, key_lap, options.max_distance_m, options.max_angle_rad)) {
        if (SameFrame(live_lap, key_lap, pair)) continue;
        data.pairs.push_back({number(live_lap, pair.live), number(key_lap, pair.key)});
      }
    }
  }
  Require(!data.pairs.empty(), live.front().folder.string(),
          fmt::format("no two frames are within {} m", options.max_distance_m),
          "give laps of the same road in one world");

  data.frames.resize(wanted.size());
  constexpr std::int64_t kBlock = 64;  // frames between two reports of progress
  const auto count = static_cast<std::int64_t>(wanted.size());
  for (std::int64_t from = 0; from < count; from += kBlock) {
    pool.For(std::min(kBlock, count - from), 1, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = from + begin; i < from + end; ++i) {
        const auto& [lap, frame] = wanted[static_cast<std::size_t>(i)];
        data.frames[static_cast<std::size_t>(i)] =
            LoadFrame(*lap, frame, crop, data.camera, options.depth_from_motion);
      }
    });
    Report(progress, "read images", std::min(from + kBlock, count), count);
  }
  return data;
}

}  // namespace recollect::cnn
