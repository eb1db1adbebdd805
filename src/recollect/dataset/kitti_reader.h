#pragma once

#include <filesystem>

#include "recollect/dataset/lap.h"

namespace recollect {

// The benchmark's 10 frames a second, for laps without times.
inline constexpr double kKittiSecondsPerFrame = 0.1;

// True where a folder bears the marks of a KITTI odometry sequence: poses.txt, calib.txt or
// image_N.
bool LooksLikeKitti(const std::filesystem::path& folder);

// One KITTI odometry sequence (Geiger et al. 2012), with two additions:
//   image_2, image_3   left and right colour images, or, where there is no image_2,
//   image_0, image_1   left and right gray ones; NUMBER.png or NUMBER.jpg. The i-th left image
//                      belongs to row i of poses.txt; right images may exist for some frames only
//   calib.txt          P0..P3: rectified 3x4 projections, row-major, each after "P0:" or bare in
//                      that order; those of the cameras without images may be missing
//   poses.txt          world_from_body of camera 0, 3x4 row-major a row
//   times.txt          seconds, one a row, increasing (optional; 10 frames a second without it)
//   depth/NUMBER.png   (addition, for some frames or all) 16 bits, centimetres, 0 unknown; of the
//                      image's size or a whole fraction of it, see DepthCamera
//   gps.csv            (addition) time,x,y,z,quality; see GpsFix
// Throws Error, naming file and line, for the first thing that is missing or wrong.
Lap ReadKittiLap(const std::filesystem::path& folder);

// The pair of cameras of a calib.txt as above: P2 and P3 where there are both, else P0 and P1.
// width, height: of its images. Throws Error as above, and where the second is not to the right.
StereoCamera ReadKittiStereo(const std::filesystem::path& calibration, int width, int height);

}  // namespace recollect
