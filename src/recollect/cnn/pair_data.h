#pragma once

#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "recollect/cnn/crop.h"
#include "recollect/core/parallel.h"
#include "recollect/core/progress.h"
#include "recollect/dataset/lap.h"

namespace recollect::cnn {

// Depth is kept for every kDepthStep-th pixel of every kDepthStep-th row of the crop.
inline constexpr int kDepthStep = 4;

// What training and evaluation need of a frame, decoded once and kept: about 200 kB a frame at
// 320 x 192 pixels, so 1,300 frames take 260 MB.
struct StoredFrame {
  cv::Mat image;  // the crop, 8-bit B, G, R
  cv::Mat depth;  // 32-bit float metres along z, 0 where unknown; empty where the lap has none
  SE3 world_from_camera;
};

// A live frame and a key frame, as indices into PairData::frames.
struct Pair {
  std::size_t live = 0, key = 0;
};

struct PairOptions {
  double max_distance_m = 5;
  double max_angle_rad = 0.6;  // between the headings
  double key_spacing_m = 0;  // key frames are thinned to one every so many metres; 0: all are used
  // Frames without a depth image get theirs from the nearest frame of the drive a metre or more
  // away (DepthFromMotion); otherwise they have none.
  bool depth_from_motion = false;
};

// Pairs with the frames they are made of.
struct PairData {
  Crop crop;
  PinholeCamera camera;  // of the crop; the same for all frames
  std::vector<StoredFrame> frames;
  std::vector<Pair> pairs;

  SE3 KeyframeFromLive(const Pair& pair) const {
    return frames[pair.key].world_from_camera.Inverse() * frames[pair.live].world_from_camera;
  }
};

// All pairs of a frame of a live lap with a key frame of a key lap within the options' bounds; a
// frame is never paired with itself (the same lap may be live and key). Order: live lap, key lap,
// live frame, key frame. Frames in no pair are not decoded. Throws Error where the laps' cameras
// differ, an image cannot be read, or no pair is left.
PairData LoadPairs(std::span<const Lap> live, std::span<const Lap> key, const Crop& crop,
                   const PairOptions& options, ThreadPool& pool, const ProgressSink& progress = {});

}  // namespace recollect::cnn
