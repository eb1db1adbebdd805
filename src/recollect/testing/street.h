#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "recollect/dataset/lap.h"

namespace recollect::testing {

// A short street for tests: a road along +x between two rows of house fronts, every house of its
// own colour and windows, cast ray by ray. World z up, metres. Not meant to look like anything,
// only to have exact geometry, texture at all scales, and places that differ.
struct StreetDrive {
  double length_m = 60;
  double spacing_m = 1;      // between frames
  double lateral_m = 0;      // of the road's middle, to the left
  double wobble_rad = 0.02;  // standard deviation of heading, pitch and roll
  double brightness = 1;     // of the day
  std::uint64_t seed = 1;    // of the wobble; the street is always the same
};

// Drives along the street with a 320 x 240 camera and writes what it sees as a KITTI-style lap:
// image_2/, depth/ (16 bit, centimetres, half size), poses.txt, times.txt, calib.txt. Returns the
// lap as read back.
Lap DriveStreet(const std::filesystem::path& folder, const StreetDrive& drive);

}  // namespace recollect::testing
