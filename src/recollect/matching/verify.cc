#include "recollect/matching/verify.h"

#include <Eigen/Cholesky>
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

// Matches of the live image with a place's landmarks, these in the camera of the place's key frame.
struct PlaceMatches {
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  std::vector<int> features;  // of the live image: of each point
  std::vector<int> matched;   // and of all matches, far ones as well
  void Append(const PlaceMatches& more) {
    points.insert(points.end(), more.points.begin(), more.points.end());
    pixels.insert(pixels.end(), more.pixels.begin(), more.pixels.end());
    features.insert(features.end(), more.features.begin(), more.features.end());
    matched.insert(matched.end(), more.matched.begin(), more.matched.end());
  }
};

// With the landmarks of one key frame; where `expected` is given, points are those only that it
// sees near to their match.
PlaceMatches MatchKeyFrame(const MappedFrames& map, const Features& live, int place, int key,
                           const VerifyOptions& options, const SE3* expected) {
  const SE3 place_from_key = PoseOf(map, place).Inverse() * PoseOf(map, key);
  const SE3 expected_from_place =
      expected != nullptr ? expected->Inverse() * PoseOf(map, place) : SE3();
  const auto far = [&](const Eigen::Vector3d& p_place, const Eigen::Vector2d& pixel) {
    if (expected == nullptr) return false;
    const Eigen::Vector3d p = expected_from_place * p_place;
    return p.z() <= 0 || (map.camera.Project(p) - pixel).norm() > options.expected_px;
  };
  PlaceMatches result;
  const Landmarks landmarks = map.landmarks(key);
  for (const Match& m :
       MatchDescriptors(live.descriptors.data(), std::min(live.size(), options.features),
                        landmarks.descriptors.data(), landmarks.size(), options.match)) {
    const Eigen::Vector3d p =
        place_from_key * landmarks.points[static_cast<std::size_t>(m.mapped)].p_keyframe;
    const Eigen::Vector2d& pixel = live.pixels[static_cast<std::size_t>(m.live)];
    result.matched.push_back(m.live);
    if (far(p, pixel)) continue;
    result.points.emplace_back(p.x(), p.y(), p.z());
    result.pixels.emplace_back(pixel.x(), pixel.y());
    result.features.push_back(m.live);
  }
  return result;
}

int CountDistinct(std::vector<int> numbers) {
  std::sort(numbers.begin(), numbers.end());
  return static_cast<int>(std::unique(numbers.begin(), numbers.end()) - numbers.begin());
}

// The pose that most matches of a place agree on.
Hypothesis Agree(const MappedFrames& map, int place, const PlaceMatches& matches,
                 const VerifyOptions& options) {
  const SE3& world_from_place = PoseOf(map, place);
  Hypothesis result{world_from_place, place, 0};
  if (static_cast<int>(matches.points.size()) < options.min_matches) return result;
  const PinholeCamera& c = map.camera;
  cv::Mat k = (cv::Mat_<double>(3, 3) << c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1);
  cv::UsacParams usac;
  usac.confidence = 0.999;
  usac.maxIterations = options.ransac_iterations;
  usac.score = cv::SCORE_METHOD_MAGSAC;
  usac.threshold = options.ransac_px;
  cv::Mat rotation_vector, translation, inliers;
  if (!cv::solvePnPRansac(matches.points, matches.pixels, k, cv::noArray(), rotation_vector,
                          translation, inliers, usac)) {
    return result;
  }
  std::vector<int> agreeing;
  for (int i = 0; i < inliers.rows; ++i) {
    agreeing.push_back(matches.features[static_cast<std::size_t>(inliers.at<int>(i))]);
  }
  const Eigen::Vector3d w(rotation_vector.at<double>(0), rotation_vector.at<double>(1),
                          rotation_vector.at<double>(2));
  const Eigen::Vector3d t(translation.at<double>(0), translation.at<double>(1),
                          translation.at<double>(2));
  if (!w.allFinite() || !t.allFinite()) return result;
  result.support = CountDistinct(agreeing);
  result.share = static_cast<double>(result.support) / CountDistinct(matches.matched);
  result.world_from_camera = world_from_place * SE3::FromRotationVector(w, t).Inverse();
  return result;
}

// Calls body(i) for all i below count, on the pool's threads where there is one.
template <typename Body>
void ForEach(ThreadPool* pool, std::size_t count, const Body& body) {
  const auto chunk = [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) body(static_cast<std::size_t>(i));
  };
  const auto all = static_cast<std::int64_t>(count);
  if (pool == nullptr) return chunk(0, all);
  pool->For(all, 1, chunk);
}

// A hypothesis a place, from its key frame and those around it.
std::vector<Hypothesis> Propose(const MappedFrames& map, const Features& live,
                                std::span<const int> places, const VerifyOptions& options,
                                ThreadPool* pool, const SE3* expected = nullptr) {
  std::vector<std::pair<std::size_t, int>> pairs;  // place and key frame
  for (std::size_t place = 0; place < places.size(); ++place) {
    for (const int key : Near(map, PoseOf(map, places[place]), options.pool_m, options.pool)) {
      pairs.emplace_back(place, key);
    }
  }
  std::vector<PlaceMatches> parts(pairs.size()), matches(places.size());
  ForEach(pool, pairs.size(), [&](std::size_t i) {
    const auto [place, key] = pairs[i];
    parts[i] = MatchKeyFrame(map, live, places[place], key, options, expected);
  });
  for (std::size_t i = 0; i < pairs.size(); ++i) matches[pairs[i].first].Append(parts[i]);
  std::vector<Hypothesis> hypotheses(places.size());
  ForEach(pool, places.size(), [&](std::size_t place) {
    hypotheses[place] = Agree(map, places[place], matches[place], options);
  });
  return hypotheses;
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

// What repeats along a road, boards and fences and house fronts, fits in many places, and in a
// wrong one at times a little better: of places about equally well supported the likeliest, which
// was proposed first.
std::size_t Choose(const std::vector<Hypothesis>& hypotheses, const VerifyOptions& options) {
  int most = 0;
  for (const Hypothesis& one : hypotheses) most = std::max(most, one.support);
  const auto good = [&](const Hypothesis& one) {
    return one.support == most ||
           (one.support >= options.repeat_support && one.support * options.repeat_ratio >= most);
  };
  return static_cast<std::size_t>(std::find_if(hypotheses.begin(), hypotheses.end(), good) -
                                  hypotheses.begin());
}

// The pose that a hypothesis leads to.
std::optional<Verified> Settle(const MappedFrames& map, const Features& live,
                               const Hypothesis& hypothesis, const VerifyOptions& options,
                               ThreadPool* pool) {
  if (hypothesis.support < options.min_matches) return std::nullopt;
  std::optional<Verified> result =
      RefineFrom(map, live, hypothesis.world_from_camera, options, {}, pool);
  if (!result) return std::nullopt;
  result->key_frame = hypothesis.key_frame;
  result->agreed = hypothesis.support;
  result->agreed_share = hypothesis.share;
  return result;
}

}  // namespace

std::optional<Verified> VerifyExpected(const MappedFrames& map, const Features& live,
                                       const SE3& expected, const VerifyOptions& options,
                                       ThreadPool* pool) {
  const std::vector<int> nearest = Near(map, expected, options.expected_m, 1);
  if (nearest.empty()) return std::nullopt;
  return Settle(map, live, Propose(map, live, nearest, options, pool, &expected).front(), options,
                pool);
}

std::optional<Verified> VerifyPlaces(const MappedFrames& map, const Features& live,
                                     std::span<const int> proposals, const VerifyOptions& options,
                                     ThreadPool* pool) {
  const std::vector<Hypothesis> hypotheses =
      Propose(map, live, Places(map, proposals, options), options, pool);
  if (hypotheses.empty()) return std::nullopt;
  const Hypothesis& best = hypotheses[Choose(hypotheses, options)];
  std::optional<Verified> result = Settle(map, live, best, options, pool);
  if (!result) return std::nullopt;
  for (const Hypothesis& one : hypotheses) {
    // Two proposals may well lead to one pose.
    const double apart =
        (one.world_from_camera.translation() - result->world_from_camera.translation()).norm();
    if (apart > options.place_m) result->rival = std::max(result->rival, one.support);
  }
  return result;
}

std::optional<Verified> RefineFrom(const MappedFrames& map, const Features& live,
                                   const SE3& world_from_camera, const VerifyOptions& options,
                                   const std::optional<PosePrior>& prior, ThreadPool* pool) {
  SE3 pose = world_from_camera;
  const PixelGrid grid(map.camera, live);
  std::optional<RefinedPose> refined;
  std::vector<Observation> matches;
  for (int round = 0; round < options.guided_rounds; ++round) {
    const std::size_t stage = round == 0 ? 0 : 1;
    const double radius = options.guided_px[stage];
    matches.clear();
    const std::vector<int> keys =
        Near(map, pose, options.refine_pool_m, options.guided_keys[stage]);
    std::vector<std::vector<Observation>> parts(keys.size());
    ForEach(pool, keys.size(), [&](std::size_t i) {
      const int key = keys[i];
      MatchGuided(map.camera, key, PoseOf(map, key), map.landmarks(key), live, grid, pose, radius,
                  options.guided_likeness, parts[i]);
    });
    for (const auto& part : parts) matches.insert(matches.end(), part.begin(), part.end());
    for (Observation& o : matches) {
      if (!map.lap.empty()) o.lap = map.lap[static_cast<std::size_t>(o.key_frame)];
    }
    if (static_cast<int>(matches.size()) < options.min_matches) return std::nullopt;
    ShareFeatures(live, matches);
    // Matches are looked for again from the first round's pose: it need not be the very last word.
    const RefineOptions refine{.max_iterations = round == 0 ? 5 : 15};
    refined = RefinePose(matches, map.camera, pose, refine, prior);
    if (!refined) return std::nullopt;
    // Other matches may move the pose further, until it moves less than it is unsure by.
    const Vector6d moved = (pose.Inverse() * refined->world_from_camera).Log();
    pose = refined->world_from_camera;
    if (round > 0 && moved.dot(refined->covariance.ldlt().solve(moved)) < 1) break;
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
