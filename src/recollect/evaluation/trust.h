#pragma once

#include <vector>

#include "recollect/evaluation/evaluate.h"

namespace recollect {

// See Trust. key_poses: world_from_camera of the map's key frames.
Trust MakeTrust(const std::vector<LiveFrame>& frames, const std::vector<SE3>& key_poses);

// Takes the frames that `leave_out` names from `sampled`, frames of `live`.
void LeaveOutMapped(const Map& map, const Lap& live, LeaveOut leave_out,
                    std::vector<std::size_t>& sampled);

}  // namespace recollect
