#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "recollect/core/parallel.h"
#include "recollect/matching/features.h"
#include "recollect/matching/landmarks.h"
#include "recollect/matching/match.h"
#include "recollect/matching/refine.h"

namespace recollect::matching {

struct VerifyOptions {
  int places = 5;            // looked at, of those the committee proposes
  double place_m = 8;        // proposals closer than this are one place
  double pool_m = 6;         // key frames so near to a place's help to verify it
  int pool = 6;              // at most so many
  double refine_pool_m = 9;  // key frames so near to the pose are matched again, guided by it
  int features = 500;        // of the live image, the strongest, that places are told apart by
  MatchOptions match;
  double ransac_px = 4;
  int ransac_iterations = 150;
  int min_matches = 8;  // fewer are not tried, and fewer inliers prove nothing
  // Of places whose support is at least repeat_support, and the best one's is less than
  // repeat_ratio times that, the likeliest wins.
  int repeat_support = 25;
  double repeat_ratio = 2;
  double expected_m = 20, expected_px = 60;  // how far off an expected pose may be
  // How far from its prediction a landmark is looked for, and in how many of these key frames at
  // most: at first, where a narrow look would only confirm a pose that is half a metre off, and
  // then.
  double guided_px[2] = {60, 7};
  int guided_keys[2] = {5, 10};
  int guided_rounds = 5;          // at most
  double guided_likeness = 0.68;  // cosine between descriptors, at least
};

// The key frames as verification sees them. `lap` and `hidden` are empty or as long as the poses.
struct MappedFrames {
  PinholeCamera camera;
  std::vector<SE3> world_from_camera;
  std::function<Landmarks(int key)> landmarks;
  std::vector<int> lap;      // by key frame: which lap it is of; empty: not known
  std::vector<char> hidden;  // by key frame: not to be used; empty: all may be
};

// A pose that matches of a live image with several key frames support.
struct Verified {
  SE3 world_from_camera;
  Matrix6d covariance = Matrix6d::Zero();  // as in RefinedPose, before any calibration
  int key_frame = -1;                      // proposed, where this place was found
  int nearest_key_frame = -1;              // to the pose
  int support = 0;    // features of the live image that show landmarks where they should be
  double spread = 0;  // share of the image's 8 x 6 cells that hold at least one of these
  int agreed = 0;  // matches that spoke for the place before it guided them; 0: from a given pose
  double agreed_share = 0;  // of the features that had a match there
  int rival = 0;            // matches that agreed on the best of the other places
};

// Looks at the proposed key frames, most likely first, place by place: matches the live image with
// the landmarks there, finds the pose that most matches agree on (P3P in MAGSAC, Barath et al.
// 2020), and refines the best supported one (of about equal ones the likeliest) over all key frames
// around it, matched again where the pose predicts them. nullopt where no place has support. The
// pool, if any, changes the time only.
std::optional<Verified> VerifyPlaces(const MappedFrames& map, const Features& live,
                                     std::span<const int> proposals,
                                     const VerifyOptions& options = {}, ThreadPool* pool = nullptr);

// The same where a pose is expected: at the key frame nearest to it, with those matches only that
// lie about where it predicts them, which tells apart what repeats along a road.
std::optional<Verified> VerifyExpected(const MappedFrames& map, const Features& live,
                                       const SE3& world_from_camera,
                                       const VerifyOptions& options = {},
                                       ThreadPool* pool = nullptr);

// The second half alone: from a pose that is about right, say a network's, which may be held to as
// far as its covariance says.
std::optional<Verified> RefineFrom(const MappedFrames& map, const Features& live,
                                   const SE3& world_from_camera, const VerifyOptions& options = {},
                                   const std::optional<PosePrior>& prior = {},
                                   ThreadPool* pool = nullptr);

// When a pose may be relied on. Chance agreement of wrong matches is what these bounds keep out.
struct SureOptions {
  int support = 25;
  double spread = 0.2;
  int agreed = 15;
  double agreed_share = 0.4;
  double agreed_over_rival = 1.5;
  double position_sigma_m = 0.3;  // as the covariance says, all axes together
};
bool IsSure(const Verified& verified, const SureOptions& options = {});

}  // namespace recollect::matching
