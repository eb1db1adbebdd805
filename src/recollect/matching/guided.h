#pragma once

#include <vector>

#include "recollect/matching/features.h"
#include "recollect/matching/landmarks.h"
#include "recollect/matching/refine.h"

namespace recollect::matching {

// Features of an image by where they are.
class PixelGrid {
 public:
  PixelGrid(const PinholeCamera& camera, const Features& features);
  // Calls visit(i) for every feature of the cells that a circle touches.
  template <typename Visit>
  void Around(const Eigen::Vector2d& pixel, double radius, const Visit& visit) const {
    const auto cell = [](double at, int cells) {
      return std::min(std::max(static_cast<int>(at / kCell), 0), cells - 1);
    };
    for (int y = cell(pixel.y() - radius, rows_); y <= cell(pixel.y() + radius, rows_); ++y) {
      for (int x = cell(pixel.x() - radius, columns_); x <= cell(pixel.x() + radius, columns_);
           ++x) {
        for (const int i : cells_[static_cast<std::size_t>(y * columns_ + x)]) visit(i);
      }
    }
  }

 private:
  static constexpr int kCell = 16;
  int columns_, rows_;
  std::vector<std::vector<int>> cells_;
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
