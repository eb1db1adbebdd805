#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "recollect/dataset/lap.h"

namespace recollect {

enum class Format { kGuess, kKitti, kTum, kUfes };

// "guess", "kitti", "tum" or "ufes". Throws Error for anything else.
Format ParseFormat(std::string_view name);

// The laps of a folder: one where the folder is a lap, all in order of their names where it holds
// laps as folders (KITTI, TUM; hidden and other folders are passed over) or as files (UFES-LAPS).
// What a format consists of is told in kitti_reader.h, tum_reader.h and ufes_reader.h. A trajectory
// file (trajectory_io.h) gives a lap of poses alone. Everything is checked but the pixels: image
// headers are read, images are not. Throws Error, naming file and line, for the first thing that is
// missing or wrong.
std::vector<Lap> ReadLaps(const std::filesystem::path& folder, Format format = Format::kGuess);

// The same where exactly one lap is wanted. Throws Error when there are more.
Lap ReadLap(const std::filesystem::path& folder, Format format = Format::kGuess);

}  // namespace recollect
