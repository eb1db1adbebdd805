#include "recollect/dataset/sampling.h"

#include "recollect/core/error.h"

namespace recollect {

std::vector<std::size_t> SampleFrames(const Lap& lap, double spacing_m, double max_yaw_rad) {
  Require(spacing_m >= 0, "spacing", fmt::format("{} m is negative", spacing_m));
  Require(max_yaw_rad > 0, "yaw limit", fmt::format("{} rad is not positive", max_yaw_rad));
  std::vector<std::size_t> kept;
  Eigen::Vector3d position = Eigen::Vector3d::Zero(), heading = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < lap.frames.size(); ++i) {
    const Eigen::Vector3d p = lap.frames[i].world_from_body.translation(), h = Heading(lap, i);
    if (!kept.empty() && (p - position).norm() < spacing_m &&
        HeadingDifference(h, heading) < max_yaw_rad) {
      continue;
    }
    kept.push_back(i);
    position = p;
    heading = h;
  }
  return kept;
}

}  // namespace recollect
