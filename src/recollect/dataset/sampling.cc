#include "recollect/dataset/sampling.h"

#include "recollect/core/error.h"

namespace recollect {

std::vector<std::size_t> SampleFrames(const Lap& lap, double spacing_m, double max_yaw_rad,
                                      YawRule rule) {
  Require(spacing_m >= 0, "spacing", fmt::format("{} m is negative", spacing_m));
  Require(max_yaw_rad > 0, "yaw limit", fmt::format("{} rad is not positive", max_yaw_rad));
  const Track track = MakeTrack(lap, rule);
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < track.size(); ++i) {
    if (kept.empty() || (track.positions[i] - track.positions[kept.back()]).norm() >= spacing_m ||
        HeadingDifference(track, i, track, kept.back()) >= max_yaw_rad) {
      kept.push_back(i);
    }
  }
  return kept;
}

}  // namespace recollect
