#include "recollect/evaluation/evaluate.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "recollect/core/error.h"
#include "recollect/dataset/image.h"
#include "recollect/dataset/sampling.h"
#include "recollect/evaluation/failures.h"
#include "recollect/evaluation/trust.h"

namespace recollect {
namespace {

constexpr int kMaximumAllowedErrors[] = {0, 1, 2, 3, 5, 10};

constexpr int kPictureWidth = 320;

// A fix further in time from an image than this says nothing of it.
constexpr double kMaxFixAge = 0.25;

// Index of the pose nearest to `p`, among those that look less than a right angle away from it.
std::size_t Nearest(const std::vector<SE3>& poses, const SE3& pose) {
  std::size_t best = 0;
  double best_distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double distance = (poses[i].translation() - pose.translation()).norm();
    if (distance >= best_distance) continue;
    if (poses[i].rotation().col(2).dot(pose.rotation().col(2)) <= 0) continue;
    best = i;
    best_distance = distance;
  }
  return best;
}

std::vector<std::size_t> EveryOf(const std::vector<std::size_t>& frames, int every) {
  Require(every >= 1, "every", fmt::format("{} is less than 1", every));
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < frames.size(); i += static_cast<std::size_t>(every)) {
    kept.push_back(frames[i]);
  }
  return kept;
}

int Apart(std::size_t a, std::size_t b) {
  return std::abs(static_cast<int>(a) - static_cast<int>(b));
}

Row MakeRow(const std::string& name, const std::vector<LiveFrame>& frames,
            const std::function<bool(const LiveFrame&)>& answered,
            const std::function<PoseError(const LiveFrame&)>& error) {
  Row row;
  row.name = name;
  std::vector<double> position, heading;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!answered(frames[i])) continue;
    row.frames.push_back(i);
    row.errors.push_back(error(frames[i]));
    position.push_back(row.errors.back().position_m);
    heading.push_back(row.errors.back().heading_deg);
  }
  row.availability = static_cast<double>(row.frames.size()) / static_cast<double>(frames.size());
  row.position_m = Summarise(position);
  row.heading_deg = Summarise(heading);
  return row;
}

std::map<int, double> SharesWithin(const std::vector<LiveFrame>& frames, int LiveFrame::*error) {
  std::map<int, double> shares;
  for (const int allowed : kMaximumAllowedErrors) {
    const auto right = std::count_if(frames.begin(), frames.end(),
                                     [&](const LiveFrame& f) { return f.*error <= allowed; });
    shares[allowed] = static_cast<double>(right) / static_cast<double>(frames.size());
  }
  return shares;
}

std::map<std::string, std::pair<double, double>> Latency(const std::vector<LiveFrame>& frames) {
  std::map<std::string, std::pair<double, double>> latency;
  const std::pair<const char*, double StepTimes::*> steps[] = {
      {"recollect", &StepTimes::recollect}, {"key_frame", &StepTimes::key_frame},
      {"relate", &StepTimes::relate},       {"features", &StepTimes::features},
      {"verify", &StepTimes::verify},       {"total", &StepTimes::total}};
  for (const auto& [name, step] : steps) {
    std::vector<double> times;
    for (const LiveFrame& frame : frames) times.push_back(frame.answer.ms.*step);
    latency[name] = {Quantile(times, 0.5), Quantile(times, 0.99)};
  }
  return latency;
}

std::map<std::string, FaultFigures> ByFault(const std::vector<LiveFrame>& frames) {
  std::map<std::string, FaultFigures> faults;
  for (const LiveFrame& f : frames) {
    if (f.fault.empty()) continue;
    FaultFigures& figures = faults[f.fault];
    ++figures.frames;
    if (f.answer.state != State::kLocalised) continue;
    ++figures.localised;
    figures.localised_max_m =
        std::max(figures.localised_max_m,
                 Compare(f.answer.world_from_camera, f.true_world_from_camera).position_m);
  }
  return faults;
}

}  // namespace

PoseError Compare(const SE3& world_from_estimate, const SE3& world_from_truth) {
  const Eigen::Vector3d a = world_from_estimate.rotation().col(2);
  const Eigen::Vector3d b = world_from_truth.rotation().col(2);
  return {(world_from_estimate.translation() - world_from_truth.translation()).norm(),
          std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi};
}

Evaluation Evaluate(Localizer& localizer, const Lap& live, const EvaluationOptions& options,
                    const ProgressSink& progress) {
  const Map& map = localizer.map();
  localizer.Reset();
  std::vector<std::size_t> sampled = SampleFrames(live, options.spacing_m);
  LeaveOutMapped(map, live, options.leave_out, sampled);
  sampled = EveryOf(sampled, options.every);
  Require(sampled.size() >= 2, live.folder.string(), "has fewer than two frames to localise");

  std::vector<SE3> key_poses, place_poses, live_poses;
  const int places = map.description().laps.front().key_frames;
  for (int key = 0; key < map.size(); ++key) {
    key_poses.push_back(map.At(key).world_from_camera);
    if (key < places) place_poses.push_back(key_poses.back());
  }
  for (const std::size_t frame : sampled) live_poses.push_back(live.WorldFromCamera(frame));

  Evaluation result;
  result.lap = live.name;
  const bool network = localizer.has_network();
  const bool geometry = localizer.relative() != Relative::kCnn;
  for (std::size_t i = 0; i < sampled.size(); ++i) {
    cv::Mat image = ReadColour(live.frames[sampled[i]].left);
    LiveFrame frame;
    if (options.spoil) frame.fault = options.spoil(image);
    frame.frame = sampled[i];
    frame.time = live.frames[sampled[i]].time;
    frame.true_world_from_camera = live_poses[i];
    frame.answer = localizer.Localize(image);
    const SE3& recollected = key_poses[static_cast<std::size_t>(frame.answer.key_frame)];
    frame.error_frames = Apart(Nearest(live_poses, recollected), i);
    frame.error_labels =
        Apart(Nearest(place_poses, recollected), Nearest(place_poses, live_poses[i]));
    const std::size_t nearest = Nearest(key_poses, live_poses[i]);
    frame.nearest_key_frame = static_cast<int>(nearest);
    const auto judge = [&](const SE3& pose) { return Compare(pose, live_poses[i]); };
    if (network) {
      const bool known = frame.answer.carried_by == Relative::kCnn && !geometry;
      frame.system =
          judge(known ? frame.answer.world_from_camera
                      : recollected * localizer.Relate(image, map.Image(frame.answer.key_frame)));
      frame.oracle_cnn =
          judge(key_poses[nearest] * localizer.Relate(image, map.Image(frame.nearest_key_frame)));
    }
    if (geometry) {
      const auto verified = localizer.Verify(image, std::span(&frame.nearest_key_frame, 1));
      if (verified) frame.pnp_oracle = judge(verified->world_from_camera);
    }
    if (geometry && IsFailure(frame.answer, judge(frame.answer.world_from_camera))) {
      cv::resize(image, frame.picture, {kPictureWidth, kPictureWidth * image.rows / image.cols}, 0,
                 0, cv::INTER_AREA);
    }
    result.frames.push_back(frame);
    Report(progress, "localise", static_cast<std::int64_t>(i + 1),
           static_cast<std::int64_t>(sampled.size()));
  }

  const std::vector<LiveFrame>& frames = result.frames;
  const auto all = [](const LiveFrame&) { return true; };
  const auto answer = [](const LiveFrame& f) {
    return Compare(f.answer.world_from_camera, f.true_world_from_camera);
  };
  const auto retrieval = [&](const LiveFrame& f) {
    return Compare(key_poses[static_cast<std::size_t>(f.answer.key_frame)],
                   f.true_world_from_camera);
  };
  const auto well_recollected = [&](const LiveFrame& f) {
    return retrieval(f).position_m <= options.good_retrieval_m;
  };
  const auto add = [&](const char* name, std::optional<PoseError> LiveFrame::*error) {
    result.rows.push_back(MakeRow(
        name, frames, [&](const LiveFrame& f) { return (f.*error).has_value(); },
        [&](const LiveFrame& f) { return *(f.*error); }));
  };
  if (network) add("system", &LiveFrame::system);
  result.rows.push_back(MakeRow("retrieval", frames, all, retrieval));
  result.rows.push_back(MakeRow("oracle", frames, all, [&](const LiveFrame& f) {
    return Compare(key_poses[static_cast<std::size_t>(f.nearest_key_frame)],
                   f.true_world_from_camera);
  }));
  if (network) add("oracle_cnn", &LiveFrame::oracle_cnn);
  if (geometry) {
    add("pnp_oracle", &LiveFrame::pnp_oracle);
    result.rows.push_back(MakeRow(
        "pnp", frames, [](const LiveFrame& f) { return f.answer.by_geometry.has_value(); },
        [](const LiveFrame& f) {
          return Compare(f.answer.by_geometry->world_from_camera, f.true_world_from_camera);
        }));
    if (localizer.relative() == Relative::kFused) {
      result.rows.push_back(MakeRow("fused", frames, all, answer));
    }
    result.rows.push_back(MakeRow(
        "localised", frames, [](const LiveFrame& f) { return f.answer.state == State::kLocalised; },
        answer));
    result.trust = MakeTrust(frames, key_poses);
  }
  if (!live.gps.empty()) {
    const auto fix = [&](const LiveFrame& f) -> const GpsFix* {
      const GpsFix* nearest = NearestFix(live, f.time);
      const bool usable = nearest->quality > 0 && std::abs(nearest->time - f.time) <= kMaxFixAge;
      return usable ? nearest : nullptr;
    };
    result.rows.push_back(MakeRow(
        "gps", frames, [&](const LiveFrame& f) { return fix(f) != nullptr; },
        [&](const LiveFrame& f) {
          const SE3& body = live.frames[f.frame].world_from_body;
          return PoseError{(fix(f)->p_world - body.translation()).norm(), 0};
        }));
    result.rows.back().has_heading = false;
  }
  if (network) {
    result.rows_good_retrieval.push_back(
        MakeRow("system", frames, well_recollected, [](const LiveFrame& f) { return *f.system; }));
  }
  result.rows_good_retrieval.push_back(MakeRow("retrieval", frames, well_recollected, retrieval));
  result.within_frames = SharesWithin(frames, &LiveFrame::error_frames);
  result.within_labels = SharesWithin(frames, &LiveFrame::error_labels);
  result.latency_ms = Latency(frames);
  result.faults = ByFault(frames);
  return result;
}

}  // namespace recollect
