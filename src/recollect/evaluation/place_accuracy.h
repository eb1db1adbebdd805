#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "recollect/core/progress.h"
#include "recollect/dataset/lap.h"
#include "recollect/wnn/network.h"

namespace recollect {

class ThreadPool;

// Place recognition as the paper judges it (section IV): the weightless network learns images with
// place labels, and is asked for those of live images.

struct LabelledImages {
  std::vector<std::filesystem::path> images;
  std::vector<int> labels;  // of places, along the route
};

struct PlaceTask {
  int places = 0;
  std::vector<LabelledImages> learnt;  // a lap each
  LabelledImages live;
  std::vector<Eigen::Vector3d> live_at;  // of the body, metres
};

// Places are the frames of the first lap, one every `spacing_m` metres; frames of other laps, at
// the same spacing, and live ones, one every `live_spacing_m`, show the nearest that looks their
// way. Throws Error for laps without images.
PlaceTask PlacesByNearest(std::span<const Lap> laps, std::span<const Lap> live, double spacing_m,
                          double live_spacing_m = 1);

// Places as in the paper's published split (registration.h), of a lap of reference: each training
// lap gives one image a place and pass, live are those images that have a place.
PlaceTask PlacesByRegistration(const Lap& reference, std::span<const Lap> laps, const Lap& live);

// The drive of registration.txt, which `recollect simulate` writes beside laps rendered along
// UFES-LAPS: positions without images, heading where the drive goes. Throws Error naming file
// and line for what are no positions.
Lap ReadRegistration(const std::filesystem::path& file);

// The label that the committee gives to each of the live images.
std::vector<int> AnswerPlaces(const wnn::NetworkOptions& network,
                              std::span<const LabelledImages> learnt, const LabelledImages& live,
                              std::uint64_t seed, ThreadPool& pool,
                              const ProgressSink& progress = {});

// How wrong an answer is, in the two readings of the paper's Maximum Allowed Error: in places, and
// in live images: how far along the drive the nearest one is that does show the place answered.
// With 0 allowed both are the same.
std::vector<int> PlacesOff(std::span<const int> answers, std::span<const int> truths);
std::vector<int> ImagesOff(std::span<const int> answers, std::span<const int> truths);

}  // namespace recollect
