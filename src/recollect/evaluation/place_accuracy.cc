#include "recollect/evaluation/place_accuracy.h"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <opencv2/core.hpp>

#include "recollect/core/error.h"
#include "recollect/core/parallel.h"
#include "recollect/dataset/image.h"
#include "recollect/dataset/registration.h"
#include "recollect/dataset/sampling.h"
#include "recollect/dataset/text_table.h"
#include "recollect/wnn/displaced.h"

namespace recollect {
namespace {

int NearestFrame(const Lap& keys, const Lap& lap, std::size_t frame) {
  const Eigen::Vector3d at = lap.frames[frame].world_from_body.translation();
  double nearest = std::numeric_limits<double>::infinity();
  int label = 0;
  for (std::size_t k = 0; k < keys.frames.size(); ++k) {
    const double distance = (keys.frames[k].world_from_body.translation() - at).norm();
    if (distance >= nearest) continue;
    if (HeadingDifference(Heading(keys, k), Heading(lap, frame)) > std::numbers::pi / 2) continue;
    nearest = distance;
    label = static_cast<int>(k);
  }
  return label;
}

void Add(const Lap& lap, std::size_t frame, int label, LabelledImages& to) {
  Require(!lap.frames[frame].left.empty(), lap.name, "holds poses without images");
  to.images.push_back(lap.frames[frame].left);
  to.labels.push_back(label);
}

void AddPlaced(const Lap& lap, const PlacedFrames& placed, LabelledImages& to) {
  for (std::size_t i = 0; i < placed.frames.size(); ++i) {
    Add(lap, placed.frames[i], static_cast<int>(placed.places[i]), to);
  }
}

wnn::ImageView View(const cv::Mat& image) {
  return {image.data, image.cols, image.rows, image.channels(),
          static_cast<std::ptrdiff_t>(image.step)};
}

}  // namespace

PlaceTask PlacesByNearest(std::span<const Lap> laps, std::span<const Lap> live, double spacing_m,
                          double live_spacing_m) {
  Require(!laps.empty(), "laps", "there are none to learn");
  PlaceTask task;
  const Lap keys = Subset(laps.front(), SampleFrames(laps.front(), spacing_m));
  task.places = static_cast<int>(keys.frames.size());
  for (const Lap& lap : laps) {
    LabelledImages& learnt = task.learnt.emplace_back();
    for (const std::size_t frame : SampleFrames(lap, spacing_m)) {
      Add(lap, frame, NearestFrame(keys, lap, frame), learnt);
    }
  }
  for (const Lap& lap : live) {
    for (const std::size_t frame : SampleFrames(lap, live_spacing_m)) {
      Add(lap, frame, NearestFrame(keys, lap, frame), task.live);
      task.live_at.push_back(lap.frames[frame].world_from_body.translation());
    }
  }
  return task;
}

PlaceTask PlacesByRegistration(const Lap& reference, std::span<const Lap> laps, const Lap& live) {
  std::vector<const Lap*> train;
  for (const Lap& lap : laps) train.push_back(&lap);
  const Registration registration = RegisterPlaces(reference, live, train);
  PlaceTask task;
  task.places = static_cast<int>(registration.places.size());
  for (std::size_t lap = 0; lap < laps.size(); ++lap) {
    AddPlaced(laps[lap], registration.train[lap], task.learnt.emplace_back());
  }
  AddPlaced(live, registration.test, task.live);
  for (const std::size_t frame : registration.test.frames) {
    task.live_at.push_back(live.frames[frame].world_from_body.translation());
  }
  return task;
}

Lap ReadRegistration(const std::filesystem::path& file) {
  const TextTable table(file);
  std::vector<Eigen::Vector3d> positions;
  for (const TextTable::Row& row : table.rows()) {
    table.RequireFields(row, 3, "a position: x y z");
    const auto p = table.Numbers<3>(row);
    positions.emplace_back(p[0], p[1], p[2]);
  }
  Require(positions.size() >= 2, file.string(), "has fewer than two positions");
  Lap lap;
  lap.name = "registration";
  lap.folder = file.parent_path();
  lap.body_forward = Eigen::Vector3d::UnitX();
  lap.world_up = Eigen::Vector3d::UnitZ();
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const std::size_t from = std::min(i, positions.size() - 2);
    const Eigen::Vector3d ahead = positions[from + 1] - positions[from];
    const double yaw = std::atan2(ahead.y(), ahead.x());
    Frame& frame = lap.frames.emplace_back();
    frame.time = static_cast<double>(i);
    frame.world_from_body = SE3::FromRotationVector({0, 0, yaw}, positions[i]);
  }
  return lap;
}

std::vector<int> AnswerPlaces(const wnn::NetworkOptions& network,
                              std::span<const LabelledImages> learnt, const LabelledImages& live,
                              std::uint64_t seed, ThreadPool& pool, const ProgressSink& progress) {
  Require(!learnt.empty() && !learnt.front().images.empty(), "places", "nothing to learn");
  const cv::Mat first = ReadColour(learnt.front().images.front());
  wnn::Encoder encoder(network, first.cols, first.rows, pool);
  wnn::Memory memory(network.neurons());
  std::int64_t total = 0, done = 0;
  for (const LabelledImages& lap : learnt) total += static_cast<std::int64_t>(lap.images.size());
  for (const LabelledImages& lap : learnt) {
    for (std::size_t i = 0; i < lap.images.size(); ++i) {
      const cv::Mat image = ReadColour(lap.images[i]);
      memory.Append(encoder.Encode(View(image)), lap.labels[i]);
      Report(progress, "learn", ++done, total);
    }
  }
  std::vector<int> answers;
  for (const auto& file : live.images) {
    const cv::Mat image = ReadColour(file);
    answers.push_back(
        wnn::RecollectImage(memory, encoder, View(image), pool, {.tie_seed = seed}).winner);
    Report(progress, "recollect", static_cast<std::int64_t>(answers.size()),
           static_cast<std::int64_t>(live.images.size()));
  }
  return answers;
}

std::vector<int> PlacesOff(std::span<const int> answers, std::span<const int> truths) {
  std::vector<int> off;
  for (std::size_t i = 0; i < answers.size(); ++i) off.push_back(std::abs(answers[i] - truths[i]));
  return off;
}

std::vector<int> ImagesOff(std::span<const int> answers, std::span<const int> truths) {
  std::vector<int> off;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    int nearest = std::numeric_limits<int>::max();
    for (std::size_t j = 0; j < truths.size(); ++j) {
      if (truths[j] != answers[i]) continue;
      nearest = std::min(nearest, std::abs(static_cast<int>(i) - static_cast<int>(j)));
    }
    off.push_back(nearest);
  }
  return off;
}

}  // namespace recollect
