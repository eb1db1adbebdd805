#pragma once

#include <filesystem>
#include <vector>

#include "recollect/dataset/lap.h"

namespace recollect {

// True where a folder holds a camerapos-*.txt.
bool LooksLikeUfes(const std::filesystem::path& folder);

// The recordings of a UFES-LAPS folder, in order of their names:
//   camerapos-NAME.txt   header, then "x y z rx ry rz timestamp left_image right_image" a row: the
//                        car's pose, see UfesVehicleFromCamera. Images are looked for by their
//                        names in the folder NAME; paths stay empty where it has none
//   cameragps-NAME.txt   (optional) header, then "x y z heading valid quality timestamp"
//   camera3.txt          "fx,cx,fy,cy,baseline": shares of the image's 640 x 480, and metres
// Throws Error, naming file and line, for the first thing that is missing or wrong.
std::vector<Lap> ReadUfesLaps(const std::filesystem::path& folder);

}  // namespace recollect
