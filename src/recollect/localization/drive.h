#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "recollect/map/map.h"
#include "recollect/matching/refine.h"
#include "recollect/wnn/committee.h"
#include "recollect/wnn/sequence.h"

namespace recollect {

// What the images before tell of where the next one was taken, when all come from one drive.
class Drive {
 public:
  // Throws Error on options out of range.
  Drive(const Map& map, const wnn::SequenceOptions& options);

  // Where the last localised poses lead, in steady motion: left camera in the map's world, metres,
  // with the covariance of leaving it (rad and m in the camera's axes); none where they are
  // unknown.
  std::optional<matching::PosePrior> Expected() const;
  // Key frames by the belief that the sequence of histograms has led to, this image's the last of
  // them: one call an image. Most likely first, at most `count`.
  std::vector<int> Believed(const wnn::Recollection& recollection, double place_m, int count);

  // The pose of the image, where it is to be relied on.
  void Learn(const std::optional<SE3>& world_from_camera);
  // Forgets all images.
  void Reset();

 private:
  std::vector<SE3> world_from_keyframe_;
  std::unique_ptr<wnn::Sequence> sequence_;
  std::optional<SE3> last_, before_last_;  // localised poses; before_last_ of the image before
  int unknown_ = 0;                        // images since last_
};

}  // namespace recollect
