#include "recollect/matching/verify.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "recollect/matching/build_landmarks.h"
#include "recollect/matching/guided.h"

namespace recollect::matching {
namespace {

// Key frames nearest to a pose that look the same way, nearest first.
std::vector<int> Near(const MappedFrames& map, const SE3& pose, double radius_m, int count) {
  std::vector<std::pair<double, int>> near;
  for (std::size_t k = 0; k < map.world_from_camera.size(); ++k) {
    if (!map.hidden.empty() && map.hidden[k] != 0) continue;
    const SE3& key = map.world_from_camera[k];
    const double distance = (key.translation() - pose.translation()).norm();
    if (distance > radius_m) continue;
    if (key.rotation().col(2).dot(pose.rotation().col(2)) < 0.5) continue;
    near.emplace_back(distance, static_cast<int>(k));
  }
  std::sort(near.begin(), near.end());
  std::vector<int> keys;
  for (const auto& [distance, key] : near) {
    if (static_cast<int>(keys.size()) == count) break;
    keys.push_back(key);
  }
  return keys;
}

struct Hypothesis {
  SE3 world_from_camera;
  int key_frame = -1;
  int support = 0;
  double share = 0;  // of the features with a match
};

const SE3& PoseOf(const MappedFrames& map, int key) {
  return map.world_from_camera[static_cast<std::size_t>(key)];
}

// The pose that most matches with the key frames around `key` agree on; of the matches near to
// where `expected` sees them, where it is given.
Hypothesis Propose(const MappedFrames& map, const Features& live, int key,
                   const VerifyOptions& options, const SE3* expected = nullptr) {
  const SE3& world_from_place = PoseOf(map, key);
  const SE3 place_from_world = world_from_place.Inverse();
  const SE3 expected_from_place =
      expected != nullptr ? expected->Inverse() * world_from_place : SE3();
  const auto far = [&](const Eigen::Vector3d& p_place, const Eigen::Vector2d& pixel) {
    if (expected == nullptr) return false;
    const Eigen::Vector3d p = expected_from_place * p_place;
    return p.z() <= 0 || (map.camera.Project(p) - pixel).norm() > options.expected_px;
  };
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  std::vector<int> features, matched;  // of the live image: of each point, of each match
  for (const int near : Near(map, world_from_place, options.pool_m, options.pool)) {
    const Landmarks landmarks = map.landmarks(near);
    const SE3 place_from_key = place_from_world * PoseOf(map, near);
    for (const Match& m :
         MatchDescriptors(live.descriptors.data(), live.size(), landmarks.descriptors.data(),
                          landmarks.size(), options.match)) {
      const Eigen::Vector3d p =
          place_from_key * landmarks.points[static_cast<std::size_t>(m.mapped)].p_keyframe;
      const Eigen::Vector2d& pixel = live.pixels[static_cast<std::size_t>(m.live)];
      matched.push_back(m.live);
      if (far(p, pixel)) continue;
      points.emplace_back(p.x(), p.y(), p.z());
      pixels.emplace_back(pixel.x(), pixel.y());
      features.push_back(m.live);
    }
  }
  Hypothesis result{world_from_place, key, 0};
  if (static_cast<int>(points.size()) < options.min_matches) return result;
  const PinholeCamera& c = map.camera;
  cv::Mat k = (cv::Mat_<double>(3, 3) << c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1);
  cv::UsacParams usac;
  usac.confidence = 0.999;
  usac.maxIterations = options.ransac_iterations;
  usac.score = cv::SCORE_METHOD_MAGSAC;
  usac.threshold = options.ransac_px;
  cv::Mat rotation_vector, translation, inliers;
  if (!cv::solvePnPRansac(points, pixels, k, cv::noArray(), rotation_vector, translation, inliers,
                          usac)) {
    return result;
  }
  std::vector<int> agreeing;
  for (int i = 0; i < inliers.rows; ++i) {
    agreeing.push_back(features[static_cast<std::size_t>(inliers.at<int>(i))]);
  }
  std::sort(agreeing.begin(), agreeing.end());
  agreeing.erase(std::unique(agreeing.begin(), agreeing.end()), agreeing.end());
  result.support = static_cast<int>(agreeing.size());
  std::sort(matched.begin(), matched.end());
  const auto count = std::unique(matched.begin(), matched.end()) - matched.begin();
  result.share = static_cast<double>(agreeing.size()) / static_cast<double>(count);
  const Eigen::Vector3d w(rotation_vector.at<double>(0), rotation_vector.at<double>(1),
                          rotation_vector.at<double>(2));
  const Eigen::Vector3d t(translation.at<double>(0), translation.at<double>(1),
                          translation.at<double>(2));
  if (!w.allFinite() || !t.allFinite()) return {world_from_place, key, 0};
  result.world_from_camera = world_from_place * SE3::FromRotationVector(w, t).Inverse();
  return result;
}

// One key frame a place, in the order proposed.
std::vector<int> Places(const MappedFrames& map, std::span<const int> proposals,
                        const VerifyOptions& options) {
  std::vector<int> places;
  for (const int key : proposals) {
    const bool known = std::any_of(places.begin(), places.end(), [&](int place) {
      return (PoseOf(map, place).translation() - PoseOf(map, key).translation()).norm() <
                 options.place_m &&
             PoseOf(map, place).rotation().col(2).dot(PoseOf(map, key).rotation().col(2)) > 0;
    });
    if (!known) places.push_back(key);
    if (static_cast<int>(places.size()) == options.places) break;
  }
  return places;
}

// The pose that a hypothesis leads to.
std::optional<Verified> Settle(const MappedFrames& map, const Features& live,
                               const Hypothesis& hypothesis, const VerifyOptions& options) {
  if (hypothesis.support < options.min_matches) return std::nullopt;
  std::optional<Verified> result = RefineFrom(map, live, hypothesis.world_from_camera, options);
  if (!result) return std::nullopt;
  result->key_frame = hypothesis.key_frame;
  result->agreed = hypothesis.support;
  result->agreed_share = hypothesis.share;
  return result;
}

}  // namespace

std::optional<Verified> VerifyExpected(const MappedFrames& map, const Features& live,
                                       const SE3& expected, const VerifyOptions& options) {
  const std::vector<int> nearest = Near(map, expected, options.expected_m, 1);
  if (nearest.empty()) return std::nullopt;
  return Settle(map, live, Propose(map, live, nearest.front(), options, &expected), options);
}

std::optional<Verified> VerifyPlaces(const MappedFrames& map, const Features& live,
                                     std::span<const int> proposals, const VerifyOptions& options) {
  Hypothesis best, rival;
  for (const int key : Places(map, proposals, options)) {
    Hypothesis one = Propose(map, live, key, options);
    if (one.support > best.support) std::swap(one, best);
    if (one.support > rival.support) rival = one;
  }
  std::optional<Verified> result = Settle(map, live, best, options);
  if (!result) return std::nullopt;
  // Two proposals may well lead to one pose.
  const double apart =
      (rival.world_from_camera.translation() - result->world_from_camera.translation()).norm();
  if (apart > options.place_m) result->rival = rival.support;
  return result;
}

std::optional<Verified> RefineFrom(const MappedFrames& map, const Features& live,
                                   const SE3& world_from_camera, const VerifyOptions& options,
                                   const std::optional<PosePrior>& prior) {
  SE3 pose = world_from_camera;
  const PixelGrid grid(map.camera, live);
  std::optional<RefinedPose> refined;
  GuidedMatches matches;
  for (const double radius : options.guided_px) {
    matches = {};
    for (const int key : Near(map, pose, options.refine_pool_m, options.refine_pool)) {
      MatchGuided(map.camera, PoseOf(map, key), map.landmarks(key), live, grid, pose, radius,
                  options.guided_likeness, matches);
    }
    if (static_cast<int>(matches.observations.size()) < options.min_matches) return std::nullopt;
    ShareFeatures(live, matches);
    refined = RefinePose(matches.observations, map.camera, pose, {}, prior);
    if (!refined) return std::nullopt;
    pose = refined->world_from_camera;
  }
  Verified result;
  result.world_from_camera = pose;
  result.covariance = refined->covariance;
  CountSupport(map.camera, live, matches, refined->deviations, result.support, result.spread);
  if (result.support < options.min_matches) return std::nullopt;
  const std::vector<int> nearest = Near(map, pose, 1e9, 1);
  result.key_frame = result.nearest_key_frame = nearest.empty() ? -1 : nearest.front();
  return result;
}

bool IsSure(const Verified& v, const SureOptions& options) {
  return v.support >= options.support && v.spread >= options.spread && v.agreed >= options.agreed &&
         v.agreed_share >= options.agreed_share &&
         v.agreed >= options.agreed_over_rival * v.rival &&
         v.covariance.bottomRightCorner<3, 3>().trace() <=
             options.position_sigma_m * options.position_sigma_m;
}

}  // namespace recollect::matching
