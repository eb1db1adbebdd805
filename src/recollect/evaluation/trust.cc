#include "recollect/evaluation/trust.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <set>

#include "recollect/matching/mapped.h"

namespace recollect {
namespace {

// 95 % of a chi-squared variable of six and of three degrees of freedom lie below.
constexpr double kChi2Of6 = 12.592, kChi2Of3 = 7.815;
constexpr double kRightPlace = 5, kHalf = 0.5;  // metres

}  // namespace

Trust MakeTrust(const std::vector<LiveFrame>& frames, const std::vector<SE3>& key_poses) {
  Trust trust;
  for (const State state : {State::kLocalised, State::kUncertain, State::kLost}) {
    trust.state_shares[Name(state)] = 0;
  }
  double localised = 0;
  for (const LiveFrame& f : frames) {
    const Localization& a = f.answer;
    const double error = Compare(a.world_from_camera, f.true_world_from_camera).position_m;
    const auto right = [&](int key) {
      const SE3& pose = key_poses[static_cast<std::size_t>(key)];
      return Compare(pose, f.true_world_from_camera).position_m <= kRightPlace ? 1 : 0;
    };
    trust.state_shares[Name(a.state)] += 1;
    trust.all_within_half_m += error <= kHalf ? 1 : 0;
    trust.place_before += right(a.key_frame);
    trust.place_after += right(a.place);
    if (a.state != State::kLocalised) continue;
    ++localised;
    trust.localised_within_half_m += error <= kHalf ? 1 : 0;
    trust.localised_max_m = std::max(trust.localised_max_m, error);
    const Vector6d xi = (a.world_from_camera.Inverse() * f.true_world_from_camera).Log();
    const Eigen::Matrix3d position = a.covariance.bottomRightCorner<3, 3>();
    if (xi.dot(a.covariance.ldlt().solve(xi)) <= kChi2Of6) ++trust.ellipsoid_pose;
    if (xi.tail<3>().dot(position.ldlt().solve(xi.tail<3>())) <= kChi2Of3) {
      ++trust.ellipsoid_position;
    }
  }
  const auto all = static_cast<double>(frames.size());
  for (auto& [name, share] : trust.state_shares) share /= all;
  for (double* share : {&trust.all_within_half_m, &trust.place_before, &trust.place_after}) {
    *share /= all;
  }
  for (double* share :
       {&trust.localised_within_half_m, &trust.ellipsoid_pose, &trust.ellipsoid_position}) {
    if (localised > 0) *share /= localised;
  }
  return trust;
}

void LeaveOutMapped(const Map& map, const Lap& live, LeaveOut leave_out,
                    std::vector<std::size_t>& sampled) {
  if (leave_out == LeaveOut::kNone) return;
  std::set<std::size_t> seen;
  const std::vector<MapLap>& laps = map.description().laps;
  for (int key = 0; key < map.size(); ++key) {
    const KeyFrame key_frame = map.At(key);
    if (laps[key_frame.lap].name != live.name) continue;
    seen.insert(key_frame.frame);
    const auto geometry = map.Geometry(key);
    if (leave_out != LeaveOut::kSources || !geometry) continue;
    for (const int source : matching::LandmarksFromBytes(*geometry, "map").sources) {
      seen.insert(static_cast<std::size_t>(source));
    }
  }
  std::erase_if(sampled, [&](std::size_t frame) { return seen.contains(frame); });
}

}  // namespace recollect
