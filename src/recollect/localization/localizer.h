#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "recollect/cnn/pose_network.h"
#include "recollect/map/map.h"
#include "recollect/wnn/encoder.h"
#include "recollect/wnn/search.h"

namespace recollect {

// Time spent on one image, milliseconds.
struct StepTimes {
  double recollect = 0;  // pattern of the image, search, votes
  double key_frame = 0;  // fetching and decoding the key frame's image
  double relate = 0;     // relative pose by the network
  double total = 0;
};

// Where an image was taken.
struct Localization {
  SE3 world_from_camera;   // G_L, in the map's world, of the left camera
  int key_frame = -1;      // the one recollected, a number in the map
  SE3 keyframe_from_live;  // T(delta)
  double confidence = 0;   // the committee's: (votes of the first - of the second) / of the first
  StepTimes ms;
};

// Localises images against a map, without any other input. Holds no state between images.
// Not to be called from two threads at a time.
class Localizer {
 public:
  // `map` and `pool` must outlive it. Throws Error where the network's crop does not fit the
  // map's images.
  Localizer(const Map& map, cnn::PoseNetwork network, ThreadPool& pool,
            const wnn::SearchOptions& search = {});

  // image: 8-bit B, G, R of the map camera's size; throws Error calling it `name` otherwise.
  Localization Localize(const cv::Mat& image, const std::string& name = "live image");

  // The two halves of Localize, for judging each by itself.
  wnn::Recollection Recollect(const cv::Mat& image, const std::string& name = "live image");
  SE3 Relate(const cv::Mat& live, const cv::Mat& key_frame);

  const Map& map() const { return map_; }

 private:
  const Map& map_;
  cnn::PoseNetwork network_;
  ThreadPool& pool_;
  wnn::SearchOptions search_;
  wnn::Encoder encoder_;
};

}  // namespace recollect
