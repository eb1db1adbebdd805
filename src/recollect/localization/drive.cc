#include "recollect/localization/drive.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "recollect/localization/proposals.h"
#include "recollect/map/trials.h"

namespace recollect {
namespace {

constexpr int kPatience = 5;    // images without a pose after which the last one leads nowhere
constexpr double kReachM = 20;  // key frames further from where it leads are not looked at
constexpr double kVotes = 1e6;  // a belief of one, as votes

}  // namespace

Drive::Drive(const Map& map, const wnn::SequenceOptions& options)
    : sequence_(wnn::MakeSequence(options, RouteOf(map))) {
  for (int key = 0; key < map.size(); ++key) {
    world_from_keyframe_.push_back(map.At(key).world_from_camera);
  }
}

std::vector<int> Drive::Tracked() const {
  if (!last_) return {};
  // Steady motion; with one pose alone, none.
  const SE3 step = before_last_ ? before_last_->Inverse() * *last_ : SE3();
  SE3 expected = *last_;
  for (int i = 0; i <= unknown_; ++i) expected = expected * step;
  std::vector<std::pair<double, int>> near;
  for (std::size_t key = 0; key < world_from_keyframe_.size(); ++key) {
    const SE3& pose = world_from_keyframe_[key];
    const double distance = (pose.translation() - expected.translation()).norm();
    if (distance > kReachM || pose.rotation().col(2).dot(expected.rotation().col(2)) < 0.5)
      continue;
    near.emplace_back(distance, static_cast<int>(key));
  }
  std::sort(near.begin(), near.end());
  std::vector<int> keys;
  for (const auto& [distance, key] : near) keys.push_back(key);
  return keys;
}

std::vector<int> Drive::Believed(const wnn::Recollection& recollection, double place_m, int count) {
  wnn::Observation observation;
  observation.histogram = recollection.histogram;
  for (const wnn::LabelVotes& one : recollection.histogram) observation.neurons += one.votes;
  const std::vector<double> belief = sequence_->Update(observation);
  std::vector<wnn::LabelVotes> votes;
  for (std::size_t place = 0; place < belief.size(); ++place) {
    const int share = static_cast<int>(std::lround(belief[place] * kVotes));
    if (share > 0) votes.push_back({static_cast<int>(place), share});
  }
  std::sort(votes.begin(), votes.end(), [](const auto& a, const auto& b) {
    return a.votes != b.votes ? a.votes > b.votes : a.label < b.label;
  });
  return ProposePlaces(votes, world_from_keyframe_, place_m, count);
}

void Drive::Learn(const std::optional<SE3>& world_from_camera) {
  if (world_from_camera) {
    before_last_ = unknown_ == 0 ? last_ : std::nullopt;
    last_ = world_from_camera;
    unknown_ = 0;
  } else if (last_ && ++unknown_ >= kPatience) {
    last_ = before_last_ = std::nullopt;
    unknown_ = 0;
  }
}

void Drive::Reset() {
  sequence_->Reset();
  last_ = before_last_ = std::nullopt;
  unknown_ = 0;
}

}  // namespace recollect
