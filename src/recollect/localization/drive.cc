#include "recollect/localization/drive.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "recollect/localization/proposals.h"
#include "recollect/map/trials.h"

namespace recollect {
namespace {

// How far a drive leaves its steady motion from one image to the next.
constexpr double kMoveSigmaM = 1, kTurnSigma = 0.05;
constexpr int kPatience = 5;    // images without a pose after which the last one leads nowhere
constexpr double kVotes = 1e6;  // a belief of one, as votes

// Votes are worth what the map says they are, where it does.
wnn::SequenceOptions WithVotes(const Map& map, wnn::SequenceOptions options) {
  if (map.description().recognition) options.votes = map.description().recognition->sequence;
  return options;
}

}  // namespace

Drive::Drive(const Map& map, const wnn::SequenceOptions& options)
    : sequence_(wnn::MakeSequence(WithVotes(map, options), RouteOf(map))) {
  for (int key = 0; key < map.size(); ++key) {
    world_from_keyframe_.push_back(map.At(key).world_from_camera);
  }
}

std::optional<matching::PosePrior> Drive::Expected() const {
  if (!last_) return std::nullopt;
  const SE3 step = before_last_ ? before_last_->Inverse() * *last_ : SE3();
  matching::PosePrior expected{*last_, Matrix6d::Zero()};
  for (int i = 0; i <= unknown_; ++i)
    expected.world_from_camera = expected.world_from_camera * step;
  const double images = unknown_ + 1;
  expected.covariance.diagonal().head<3>().setConstant(std::pow(kTurnSigma * images, 2));
  expected.covariance.diagonal().tail<3>().setConstant(std::pow(kMoveSigmaM * images, 2));
  return expected;
}

std::vector<int> Drive::Believed(const wnn::Recollection& recollection, double place_m, int count) {
  wnn::Observation observation;
  observation.histogram = recollection.histogram;
  observation.neurons = recollection.neurons_read;
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
