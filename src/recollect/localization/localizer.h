#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "recollect/cnn/pose_network.h"
#include "recollect/localization/drive.h"
#include "recollect/map/map.h"
#include "recollect/matching/verify.h"
#include "recollect/wnn/encoder.h"
#include "recollect/wnn/explanation.h"
#include "recollect/wnn/search.h"

namespace recollect {

// Who says where the camera stood relative to the key frames.
enum class Relative {
  kCnn,    // the paper's: the network, from the recollected key frame
  kPnp,    // geometry: landmarks of the best supported place; without any, the key frame's pose
  kFused,  // geometry where it is sure; else both together, else the network
};
std::string Name(Relative relative);

// How far an answer is to be relied on.
enum class State {
  kLocalised,  // many matches all over the image agree on it, and no other place comes near
  kUncertain,  // the most likely answer, resting on less than that
  kLost,       // nothing speaks for it but the committee
};
std::string Name(State state);

// Time spent on one image, milliseconds.
struct StepTimes {
  double recollect = 0;  // pattern of the image, search, votes
  double key_frame = 0;  // fetching and decoding the key frame's image
  double relate = 0;     // relative pose by the network
  double features = 0;   // of the live image
  double verify = 0;     // matching, poses and refinement
  double total = 0;
};

// Where an image was taken.
struct Localization {
  SE3 world_from_camera;  // G_L, in the map's world, of the left camera
  int key_frame = -1;     // the one recollected, a number in the map; of a drive, by all its images
  int place = -1;         // the key frame that stands for the answer's place once it is verified
  SE3 keyframe_from_live;  // T(delta): world_from_camera as seen from key_frame
  double confidence = 0;   // the committee's: (votes of the first - of the second) / of the first
  std::vector<wnn::LabelVotes> votes;  // of the key frames with most, at most five
  // Of the committee's place being right within one key frame; none where the map has no
  // MapDescription::recognition.
  std::optional<double> probability;
  // False: less likely than the precision wanted asks for. Such an image is lost, unless geometry
  // by itself localised it.
  bool recognised = true;
  std::optional<wnn::Explanation> explanation;  // where that was asked for
  // Of world_from_camera: the truth is world_from_camera * Exp(xi), xi ~ N(0, covariance), rotation
  // first: rad and m in the camera's axes. Of the network: what it predicts,
  // or where it predicts none its errors on its validation pairs.
  Matrix6d covariance = Matrix6d::Zero();
  State state = State::kUncertain;
  Relative carried_by = Relative::kCnn;           // which part the pose comes from
  int support = 0;                                // features that agree with it
  double spread = 0;                              // share of the image that these are spread over
  std::optional<matching::Verified> by_geometry;  // what geometry found by itself, if anything
  StepTimes ms;
};

struct LocalizerOptions {
  std::optional<Relative> relative;  // none: fused, or what map and network allow
  wnn::SearchOptions search;
  matching::VerifyOptions verify;
  matching::SureOptions sure;
  int proposals = 40;  // key frames of the committee that verification chooses places from
  // Images come from one drive, in order: those before say where to look (geometry only). None:
  // each image by itself.
  std::optional<wnn::SequenceOptions> sequence;
  // Of the places recognised, so many are to be right; images that are too unlikely to be are lost.
  // Needs a map with MapDescription::recognition. None: no image is refused.
  std::optional<double> precision;
  bool explain = false;  // which neurons voted for the key frame recollected, and for which else
};

// Localises images against a map, without any other input. Remembers nothing from image to image
// but what LocalizerOptions::sequence asks for.
// Not to be called from two threads at a time.
class Localizer {
 public:
  // `map` and `pool` must outlive it. Throws Error where the network's crop does not fit the map's
  // images, or options ask for a network that is not given or geometry that the map has not.
  Localizer(const Map& map, std::optional<cnn::PoseNetwork> network, ThreadPool& pool,
            const LocalizerOptions& options = {});

  // image: 8-bit B, G, R of the map camera's size; throws Error calling it `name` otherwise.
  Localization Localize(const cv::Mat& image, const std::string& name = "live image");

  // The next image does not follow on the last one.
  void Reset();

  // The parts of Localize, for judging each by itself.
  wnn::Recollection Recollect(const cv::Mat& image, const std::string& name = "live image");
  SE3 Relate(const cv::Mat& live, const cv::Mat& key_frame);
  // By geometry alone, from what the committee proposes or from key frames named by the caller.
  std::optional<matching::Verified> Verify(const cv::Mat& image, std::span<const int> proposals);

  const Map& map() const { return map_; }
  bool has_network() const { return network_.has_value(); }
  Relative relative() const { return relative_; }

 private:
  // Each sets what it knows of the answer.
  void Judge(const cv::Mat& image, const wnn::Recollection& recollection, Localization& answer);
  void RelateByNetwork(const cv::Mat& image, Localization& answer);
  void RelateByGeometry(const cv::Mat& image, const wnn::Recollection& recollection,
                        Localization& answer);
  bool IsRecollected(const wnn::Recollection& recollection, const SE3& world_from_camera) const;
  // Whether a drive's image is the very one before: the camera hangs, whatever it shows.
  bool IsFrozen(const cv::Mat& image);
  // Key frames that verification chooses places from, those of the sequence among them.
  std::vector<int> Propose(const wnn::Recollection& recollection);
  // The rest of RelateByGeometry, once verification is not sure.
  void RelateTogether(const cv::Mat& image, const matching::Features& live, int likeliest,
                      Localization& answer);
  void Take(const matching::Verified& verified, Relative carried_by, Localization& answer) const;
  cnn::RelativeEstimate Estimate(const cv::Mat& live, const cv::Mat& key_frame);
  // Of a network's answer: what it says itself, else its errors on its validation pairs.
  Matrix6d NetworkCovariance(const cnn::RelativeEstimate& estimate) const;

  const Map& map_;
  std::optional<cnn::PoseNetwork> network_;
  ThreadPool& pool_;
  LocalizerOptions options_;
  Relative relative_;
  matching::MappedFrames frames_;
  wnn::Encoder encoder_;
  wnn::Route route_;
  std::optional<Drive> drive_;
  cv::Mat last_image_;  // of the drive
};

}  // namespace recollect
