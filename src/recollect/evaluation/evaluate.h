#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "recollect/core/progress.h"
#include "recollect/dataset/lap.h"
#include "recollect/evaluation/statistics.h"
#include "recollect/localization/localizer.h"

namespace recollect {

// How far an estimated pose is from the true one.
struct PoseError {
  double position_m = 0;
  double heading_deg = 0;  // between the directions ahead
};

// One way to say where each image was taken, over the frames of the live lap. The paper's system
// never stands alone: beside it, from the same frames (the recollected key frame is the committee's
// or, where the localizer follows a drive, the one that the filter believes in most),
//   system      WNN + CNN: the recollected key frame and the regressed pose to it
//   retrieval   the recollected key frame's pose as it is
//   oracle      the nearest key frame's pose as it is, which no system is told
//   oracle_cnn  the nearest key frame and the regressed pose to it (the paper's GT + CNN)
//   pnp_oracle  geometry, told the nearest key frame; images where it finds a pose
//   pnp         geometry on the committee's places; images where it finds a pose
//   fused       geometry and network together, on all images
//   localised   of fused (of pnp without a network) the answers in that state
//   gps         the satellite receiver's position, where the lap has one
struct Row {
  std::string name;
  std::vector<std::size_t> frames;  // indices into Evaluation::frames that have an answer
  std::vector<PoseError> errors;    // of those
  double availability = 0;          // their share
  bool has_heading = true;
  Summary position_m, heading_deg;
};

// What became of one live image.
struct LiveFrame {
  std::size_t frame = 0;  // in the lap
  double time = 0;
  SE3 true_world_from_camera;
  int nearest_key_frame = 0;  // the oracle's
  Localization answer;
  std::optional<PoseError> system, oracle_cnn, pnp_oracle;  // see Row; none: it was not asked
  std::string fault;     // what EvaluationOptions::spoil did to the image; empty: there is none
  cv::Mat picture;       // the live image made small, of failures only (failures.h)
  int error_frames = 0;  // |frames| between this one and that nearest to the recollected key frame
  int error_labels = 0;  // |places| between this one's and the recollected key frame's
};

// What the answers' own word is worth.
struct Trust {
  std::map<std::string, double> state_shares;         // of all images, by name of the state
  double all_within_half_m = 0;                       // share of all images
  double localised_within_half_m = 0;                 // share of the answers marked localised
  double localised_max_m = 0;                         // the worst of them
  double ellipsoid_pose = 0, ellipsoid_position = 0;  // share of them in their 95 % ellipsoid
  double place_before = 0, place_after = 0;           // key frame within 5 m: recollected, verified
};

// Frames of the live lap that took part in the map, where it is one of its laps.
enum class LeaveOut {
  kNone,
  kKeyFrames,  // those that became key frames
  kSources,    // also those whose images the key frames' geometry was made of
};

struct EvaluationOptions {
  double spacing_m = 1;         // the live lap is thinned to this,
  int every = 1;                // and of what is left each so many-th is localised
  double good_retrieval_m = 5;  // see Evaluation::rows_good_retrieval
  LeaveOut leave_out = LeaveOut::kNone;
  // Called on each live image, in order, before anything looks at it: may spoil it, and names what
  // it did. Empty: images are left as they are.
  std::function<std::string(cv::Mat& image)> spoil;
};

// What became of the images of one fault.
struct FaultFigures {
  int frames = 0, localised = 0;
  double localised_max_m = 0;  // the worst of the localised
};

struct Evaluation {
  std::string lap;
  std::vector<LiveFrame> frames;
  std::vector<Row> rows;
  // `system` and `retrieval` again, only where the recollected key frame lies within
  // good_retrieval_m of the truth: what the network adds where it has a chance.
  std::vector<Row> rows_good_retrieval;
  // Maximum Allowed Error -> share of frames whose place is right within it, in both readings of
  // the paper: counted in live frames, and in the map's places (key frames of its first lap).
  std::map<int, double> within_frames, within_labels;
  std::optional<Trust> trust;                  // where geometry took part
  std::map<std::string, FaultFigures> faults;  // by name; empty where images were left as they are
  // Step -> p50, p99 in milliseconds.
  std::map<std::string, std::pair<double, double>> latency_ms;
};

// Localises the frames of a lap that was not mapped and judges the answers. Throws Error where lap
// and map do not share a camera, or the lap has no images or fewer than two frames.
Evaluation Evaluate(Localizer& localizer, const Lap& live, const EvaluationOptions& options = {},
                    const ProgressSink& progress = {});

// Of a and b, as angle between where their cameras look, and between their centres.
PoseError Compare(const SE3& world_from_estimate, const SE3& world_from_truth);

}  // namespace recollect
