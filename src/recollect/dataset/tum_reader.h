#pragma once

#include <filesystem>

#include "recollect/dataset/lap.h"

namespace recollect {

// True where a folder holds rgb.txt or groundtruth.txt.
bool LooksLikeTum(const std::filesystem::path& folder);

// A sequence in the layout of the TUM RGB-D benchmark (Sturm et al. 2012):
//   rgb.txt           "time file" a row, files relative to the folder
//   depth.txt         the same for depth images of 16 bits, 1/5000 m a step (optional); an image
//                     gets the nearest in time, within 0.02 s
//   groundtruth.txt   the camera's poses, see ReadTumTrajectory, in between interpolated; images
//                     further than 0.02 s from any pose are left out
//   calibration.txt   "fx fy cx cy", pixels (as ETH3D adds it); without it images must be 640 x 480
//                     and have the benchmark's default, 525 525 319.5 239.5
// Throws Error, naming file and line, for the first thing that is missing or wrong.
Lap ReadTumLap(const std::filesystem::path& folder);

}  // namespace recollect
