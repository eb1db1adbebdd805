#include "recollect/localization/localizer.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

#include "recollect/core/error.h"
#include "recollect/core/stopwatch.h"
#include "recollect/localization/proposals.h"
#include "recollect/map/trials.h"
#include "recollect/matching/mapped.h"
#include "recollect/wnn/displaced.h"

namespace recollect {
namespace {

constexpr std::size_t kVotesKept = 5;

// Within three standard deviations, in position.
bool IsNear(const matching::PosePrior& expected, const SE3& world_from_camera) {
  const double sigma_m = std::sqrt(expected.covariance(5, 5));
  return (world_from_camera.translation() - expected.world_from_camera.translation()).norm() <
         3 * sigma_m;
}

wnn::ImageView ViewOf(const cv::Mat& image) {
  return {image.data, image.cols, image.rows, 3, static_cast<std::ptrdiff_t>(image.step)};
}

Relative Choose(const std::optional<Relative>& wanted, bool network, bool geometry) {
  if (!wanted) {
    Require(network || geometry, "localizer", "has neither a network nor a map with geometry",
            "give --model, or create the map with --geometry");
    return !geometry ? Relative::kCnn : network ? Relative::kFused : Relative::kPnp;
  }
  Require(*wanted == Relative::kPnp || network, "localizer",
          fmt::format("'{}' needs a network", Name(*wanted)), "give --model");
  Require(*wanted == Relative::kCnn || geometry, "localizer",
          fmt::format("'{}' needs geometry, the map has none", Name(*wanted)),
          "create the map with --geometry");
  return *wanted;
}

}  // namespace

std::string Name(Relative relative) {
  return relative == Relative::kCnn ? "cnn" : relative == Relative::kPnp ? "pnp" : "fused";
}

std::string Name(State state) {
  return state == State::kLocalised   ? "localised"
         : state == State::kUncertain ? "uncertain"
                                      : "lost";
}

Localizer::Localizer(const Map& map, std::optional<cnn::PoseNetwork> network, ThreadPool& pool,
                     const LocalizerOptions& options)
    : map_(map),
      network_(std::move(network)),
      pool_(pool),
      options_(options),
      relative_(Choose(options.relative, network_.has_value(), map.HasGeometry())),
      frames_(matching::FramesOf(map)),
      encoder_(map.description().network, map.description().camera.left.width,
               map.description().camera.left.height, pool),
      route_(RouteOf(map)) {
  Require(map.size() > 0, "map", "has no key frames");
  Require(!options.precision || map.description().recognition, "map",
          "does not tell how sure its answers are, so none can be refused",
          "measure that with: recollect map calibrate MAP");
  if (options.sequence) drive_.emplace(map, *options.sequence);
}

void Localizer::Reset() {
  if (drive_) drive_->Reset();
  last_image_ = cv::Mat();
}

Localization Localizer::Localize(const cv::Mat& image, const std::string& name) {
  Localization answer;
  Stopwatch step, whole;

  // Section III-A: the committee of neurons recollects the most similar key frame.
  const wnn::Recollection recollection = Recollect(image, name);
  answer.key_frame = answer.place = recollection.winner;
  answer.confidence = recollection.confidence;
  const std::size_t kept = std::min<std::size_t>(kVotesKept, recollection.histogram.size());
  answer.votes.assign(recollection.histogram.begin(),
                      recollection.histogram.begin() + static_cast<std::ptrdiff_t>(kept));
  answer.ms.recollect = step.Milliseconds();
  Judge(image, recollection, answer);

  // Section III: G_L = G_K T(delta), T(delta) by the siamese network (III-B) or from landmarks.
  if (relative_ == Relative::kCnn) {
    RelateByNetwork(image, answer);
  } else {
    RelateByGeometry(image, recollection, answer);
  }
  answer.keyframe_from_live =
      map_.At(answer.key_frame).world_from_camera.Inverse() * answer.world_from_camera;
  if (!answer.recognised && answer.state != State::kLocalised) answer.state = State::kLost;
  answer.ms.total = whole.Milliseconds();
  return answer;
}

void Localizer::Judge(const cv::Mat& image, const wnn::Recollection& recollection,
                      Localization& answer) {
  const auto& calibration = map_.description().recognition;
  if (calibration) {
    answer.probability =
        wnn::Judge(*calibration, route_, recollection.histogram, recollection.neurons_read)
            .probability;
  }
  if (options_.precision) {
    answer.recognised = *answer.probability >= wnn::ThresholdFor(*calibration, *options_.precision);
  }
  if (options_.explain) {
    answer.explanation = wnn::Explain(map_.memory(), encoder_, ViewOf(image), recollection,
                                      wnn::RunnerUp(route_, recollection));
  }
}

void Localizer::RelateByNetwork(const cv::Mat& image, Localization& answer) {
  Stopwatch step;
  const KeyFrame key_frame = map_.At(answer.key_frame);
  const cv::Mat key_image = map_.Image(answer.key_frame);
  answer.ms.key_frame = step.Milliseconds();
  step.Restart();
  const cnn::RelativeEstimate estimate = Estimate(image, key_image);
  answer.world_from_camera = key_frame.world_from_camera * estimate.keyframe_from_live;
  answer.covariance = NetworkCovariance(estimate);
  answer.carried_by = Relative::kCnn;
  answer.state = State::kUncertain;
  answer.ms.relate = step.Milliseconds();
}

void Localizer::RelateByGeometry(const cv::Mat& image, const wnn::Recollection& recollection,
                                 Localization& answer) {
  Stopwatch step;
  const matching::Features live = matching::FindFeatures(matching::ToGray(image));
  answer.ms.features = step.Milliseconds();
  step.Restart();
  // Where the drive leads is looked at first, and if that is sure, nowhere else.
  const auto expected = drive_ ? drive_->Expected() : std::nullopt;
  const std::vector<int> proposals = Propose(recollection);
  if (drive_) answer.key_frame = answer.place = proposals.front();
  std::optional<matching::Verified> verified;
  if (expected) {
    verified = matching::VerifyExpected(frames_, live, expected->world_from_camera, options_.verify,
                                        &pool_);
  }
  bool sure = verified && matching::IsSure(*verified, options_.sure) &&
              IsNear(*expected, verified->world_from_camera);
  if (!sure) {
    verified = matching::VerifyPlaces(frames_, live, proposals, options_.verify, &pool_);
    sure = verified && matching::IsSure(*verified, options_.sure);
  }
  answer.by_geometry = verified;
  answer.ms.verify = step.Milliseconds();
  if (verified && (relative_ == Relative::kPnp || sure)) {
    Take(*verified, Relative::kPnp, answer);
  } else if (relative_ == Relative::kFused) {
    RelateTogether(image, live, proposals.front(), answer);
  } else {
    answer.place = proposals.front();
    answer.world_from_camera = map_.At(answer.place).world_from_camera;
    answer.covariance.diagonal() << 0.01, 0.01, 0.01, 25, 25, 25;
    answer.carried_by = Relative::kPnp;
    answer.state = State::kLost;
  }
  // What repeats along a road (fences, boards, house fronts) fits in many places: an answer needs a
  // witness that is not geometry, the drive so far or else the committee.
  const bool witnessed = expected ? IsNear(*expected, answer.world_from_camera)
                                  : IsRecollected(recollection, answer.world_from_camera);
  const bool frozen = drive_ && IsFrozen(image);
  if (answer.state == State::kLocalised && (!witnessed || frozen)) {
    answer.state = State::kUncertain;
  }
  if (drive_) {
    const bool known = answer.state == State::kLocalised;
    drive_->Learn(known ? std::optional(answer.world_from_camera) : std::nullopt);
  }
}

// Whether the committee's first place is about there.
bool Localizer::IsRecollected(const wnn::Recollection& recollection,
                              const SE3& world_from_camera) const {
  const SE3& key = frames_.world_from_camera[static_cast<std::size_t>(recollection.winner)];
  return (key.translation() - world_from_camera.translation()).norm() < options_.verify.place_m;
}

// Even a camera that stands still sees other noise in each picture.
bool Localizer::IsFrozen(const cv::Mat& image) {
  const bool same =
      image.size() == last_image_.size() && cv::norm(image, last_image_, cv::NORM_INF) == 0;
  last_image_ = image.clone();
  return same;
}

std::vector<int> Localizer::Propose(const wnn::Recollection& recollection) {
  const double place_m = options_.verify.place_m;
  const std::vector<int> by_votes =
      ProposePlaces(recollection.histogram, frames_.world_from_camera, place_m, options_.proposals);
  if (!drive_) return by_votes;
  const std::vector<int> by_belief = drive_->Believed(recollection, place_m, options_.proposals);
  std::vector<int> proposals;
  for (std::size_t i = 0; i < std::max(by_belief.size(), by_votes.size()); ++i) {
    if (i < by_belief.size()) proposals.push_back(by_belief[i]);
    if (i < by_votes.size()) proposals.push_back(by_votes[i]);
  }
  return proposals;
}

// The network's pose leads to matches that stood out too little by themselves. It starts from where
// verification points, else from the likeliest place.
void Localizer::RelateTogether(const cv::Mat& image, const matching::Features& live, int likeliest,
                               Localization& answer) {
  const std::optional<matching::Verified>& verified = answer.by_geometry;
  const int recollected = answer.key_frame;
  answer.key_frame = verified ? verified->key_frame : likeliest;
  RelateByNetwork(image, answer);
  answer.place = answer.key_frame;
  answer.key_frame = recollected;
  const Stopwatch step;
  const auto together = matching::RefineFrom(
      frames_, live, answer.world_from_camera, options_.verify,
      matching::PosePrior{answer.world_from_camera, answer.covariance}, &pool_);
  answer.ms.verify += step.Milliseconds();
  if (together && (!verified || together->support > verified->support)) {
    Take(*together, Relative::kFused, answer);
  } else if (verified) {
    Take(*verified, Relative::kPnp, answer);
  } else {
    answer.state = State::kLost;
  }
}

void Localizer::Take(const matching::Verified& verified, Relative carried_by,
                     Localization& answer) const {
  const double inflation = std::max(1.0, map_.description().geometry_inflation);
  answer.world_from_camera = verified.world_from_camera;
  answer.covariance = inflation * inflation * verified.covariance;
  answer.place = verified.nearest_key_frame;
  answer.support = verified.support;
  answer.spread = verified.spread;
  answer.carried_by = carried_by;
  answer.state = matching::IsSure(verified, options_.sure) ? State::kLocalised : State::kUncertain;
}

Matrix6d Localizer::NetworkCovariance(const cnn::RelativeEstimate& estimate) const {
  if (estimate.covariance) return *estimate.covariance;
  const cnn::PairFigures& figures = network_->info().validation;
  // Without validation: as bad as a key frame's own pose, 2 m and 3 degrees.
  const double position = figures.pairs > 0 ? figures.position_mean_m : 2;
  const double heading =
      (figures.pairs > 0 ? figures.heading_mean_deg : 3) * std::numbers::pi / 180;
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal().head<3>().setConstant(heading * heading);
  covariance.diagonal().tail<3>().setConstant(position * position);
  return covariance;
}

std::optional<matching::Verified> Localizer::Verify(const cv::Mat& image,
                                                    std::span<const int> proposals) {
  return matching::VerifyPlaces(frames_, matching::FindFeatures(matching::ToGray(image)), proposals,
                                options_.verify, &pool_);
}

wnn::Recollection Localizer::Recollect(const cv::Mat& image, const std::string& name) {
  const PinholeCamera& camera = map_.description().camera.left;
  Require(image.type() == CV_8UC3 && image.cols == camera.width && image.rows == camera.height,
          name,
          fmt::format("is {}x{} with {} channels, the map's are {}x{} in colour", image.cols,
                      image.rows, image.channels(), camera.width, camera.height),
          "localise with the camera that made the map");
  return wnn::RecollectImage(map_.memory(), encoder_, ViewOf(image), pool_, options_.search);
}

SE3 Localizer::Relate(const cv::Mat& live, const cv::Mat& key_frame) {
  return Estimate(live, key_frame).keyframe_from_live;
}

cnn::RelativeEstimate Localizer::Estimate(const cv::Mat& live, const cv::Mat& key_frame) {
  Require(network_.has_value(), "localizer", "has no network", "give --model");
  const cnn::Crop& crop = network_->crop();
  const cnn::CropPair pair{crop.Apply(live, "live image"), crop.Apply(key_frame, "key frame")};
  return network_->Estimate(std::span(&pair, 1)).front();
}

}  // namespace recollect
