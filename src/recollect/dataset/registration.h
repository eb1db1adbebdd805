#pragma once

#include <cstddef>
#include <vector>

#include "recollect/dataset/track.h"

namespace recollect {

// Place labels as the paper's place recogniser learns and is tested on: a lap of reference, thinned
// to one frame every few metres, gives the places; every other frame is of the place whose frame it
// matches along the route (MatchAlongRoute).

// Frames of a lap and the place each shows; both of one length.
struct PlacedFrames {
  std::vector<std::size_t> frames;  // indices into Lap::frames, increasing
  std::vector<std::size_t> places;  // indices into Registration::places
};

struct Registration {
  std::vector<std::size_t> places;  // indices into the reference lap's frames
  PlacedFrames test;                // every sampled frame of the test lap that has a place
  std::vector<PlacedFrames> train;  // one a training lap; see RegisterPlaces
};

struct RegistrationOptions {
  double place_spacing = 5;  // metres between places
  double frame_spacing = 1;  // metres between the frames of test and training laps
  double max_distance = 5;   // metres from a frame to its place at most
  YawRule yaw_rule = YawRule::kShortest;
};

// Each lap first loses what comes after its loop closes (LoopEnd), and is thinned. A training lap
// keeps one frame for each time it passes a place that the test visits: the one nearest to the
// centroid of the test's frames there. As in the published split the first frame of each pass is
// no candidate for that, and the last pass of the lap is left out.
// Throws Error when two laps have no common start.
Registration RegisterPlaces(const Lap& reference, const Lap& test,
                            const std::vector<const Lap*>& train,
                            const RegistrationOptions& options = {});

// How many frames a drive has before it comes back to its first frame for the last time: up to the
// last one within `radius` metres of it and at least 0.1 m nearer than the one before; where there
// is none, all but the last frame.
std::size_t LoopEnd(const Lap& lap, double radius);

}  // namespace recollect
