#include "recollect/dataset/pairing.h"

namespace recollect {

std::vector<FramePair> PairsWithin(const Lap& live, const Lap& key, double max_distance_m,
                                   double max_angle_rad) {
  std::vector<Eigen::Vector3d> key_position, key_heading;
  for (std::size_t k = 0; k < key.frames.size(); ++k) {
    key_position.push_back(key.WorldFromCamera(k).translation());
    key_heading.push_back(Heading(key, k));
  }
  std::vector<FramePair> pairs;
  for (std::size_t l = 0; l < live.frames.size(); ++l) {
    const Eigen::Vector3d position = live.WorldFromCamera(l).translation();
    const Eigen::Vector3d heading = Heading(live, l);
    for (std::size_t k = 0; k < key.frames.size(); ++k) {
      if ((key_position[k] - position).squaredNorm() <= max_distance_m * max_distance_m &&
          HeadingDifference(key_heading[k], heading) <= max_angle_rad) {
        pairs.push_back({l, k});
      }
    }
  }
  return pairs;
}

}  // namespace recollect
