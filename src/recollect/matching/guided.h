#pragma once

#include <algorithm>
#include <vector>

#include "recollect/matching/features.h"
#include "recollect/matching/landmarks.h"
#include "recollect/matching/refine.h"

namespace recollect::matching {

// Features of an image by where they are. `features` must outlive it.
class PixelGrid {
 public:
  PixelGrid(const PinholeCamera& camera, const Features& features);
  // Appends the features at most `radius` pixels from there.
  void Around(const Eigen::Vector2d& pixel, double radius, std::vector<int>& found) const;

 private:
  static constexpr int kCell = 16;
  int Cell(double at, int cells) const {
    return std::clamp(static_cast<int>(at / kCell), 0, cells - 1);
  }

  const Features& features_;
  int columns_, rows_;
  std::vector<int> order_;  // features, cell by cell
  std::vector<int> first_;  // of a cell, in order_; one more than there are cells
};

// Appends the landmarks of a key frame that the live image, taken from about `pose`, shows within
// `radius` pixels of their prediction: each with its most alike feature, and each feature with its
// most alike landmark of this key frame.
void MatchGuided(const PinholeCamera& camera, int key_frame, const SE3& world_from_keyframe,
                 const Landmarks& landmarks, const Features& live, const PixelGrid& grid,
                 const SE3& pose, double radius, double likeness,
                 std::vector<Observation>& matches);

// Several landmarks seen in one feature share its error: it is scaled so that together they know
// no more of it than one would.
void ShareFeatures(const Features& live, std::vector<Observation>& matches);

// Features with at least one observation within three standard deviations, and the share of the
// image's cells they are in.
void CountSupport(const PinholeCamera& camera, const Features& live,
                  const std::vector<Observation>& matches, const std::vector<double>& deviations,
                  int& support, double& spread);

}  // namespace recollect::matching
