#include "recollect/dataset/reader.h"

#include <algorithm>
#include <array>
#include <utility>

#include "recollect/core/error.h"
#include "recollect/dataset/kitti_reader.h"
#include "recollect/dataset/text_table.h"
#include "recollect/dataset/trajectory_io.h"
#include "recollect/dataset/tum_reader.h"
#include "recollect/dataset/ufes_reader.h"

namespace recollect {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::pair<std::string_view, Format>, 4> kFormats = {{{"guess", Format::kGuess},
                                                                          {"kitti", Format::kKitti},
                                                                          {"tum", Format::kTum},
                                                                          {"ufes", Format::kUfes}}};

// The format whose marks the folder bears, kGuess where it bears none.
Format FormatOf(const fs::path& folder) {
  if (LooksLikeKitti(folder)) return Format::kKitti;
  if (LooksLikeTum(folder)) return Format::kTum;
  if (LooksLikeUfes(folder)) return Format::kUfes;
  return Format::kGuess;
}

std::vector<Lap> ReadFolder(const fs::path& folder, Format format) {
  switch (format) {
    case Format::kKitti:
      return {ReadKittiLap(folder)};
    case Format::kTum:
      return {ReadTumLap(folder)};
    case Format::kUfes:
      return ReadUfesLaps(folder);
    case Format::kGuess:
      break;
  }
  return {};
}

// A lap of poses alone, from a file of one of the trajectory formats: told by its rows' length.
Lap ReadTrajectoryFile(const fs::path& path, Format format) {
  if (format == Format::kGuess) {
    const TextTable table(path);
    const std::size_t fields = table.rows().empty() ? 0 : table.rows().front().fields.size();
    format = fields == 8 ? Format::kTum : fields == 12 ? Format::kKitti : Format::kGuess;
  }
  Lap lap;
  lap.name = path.stem().string();
  lap.folder = path.parent_path();
  switch (format) {
    case Format::kTum: {
      const Trajectory trajectory = ReadTumTrajectory(path);
      for (const auto& [time, pose] : trajectory.poses()) {
        lap.frames.push_back({time, pose, {}, {}, {}});
      }
      return lap;
    }
    case Format::kKitti:
      for (const SE3& pose : ReadKittiPoses(path)) {
        const double time = kKittiSecondsPerFrame * static_cast<double>(lap.frames.size());
        lap.frames.push_back({time, pose, {}, {}, {}});
      }
      return lap;
    default:
      throw Error(path.string(), "is neither a folder nor a trajectory",
                  "trajectories have 8 numbers a row (TUM) or 12 (KITTI)");
  }
}

}  // namespace

Format ParseFormat(std::string_view name) {
  const auto found = std::find_if(kFormats.begin(), kFormats.end(),
                                  [&](const auto& entry) { return entry.first == name; });
  Require(found != kFormats.end(), "format", fmt::format("'{}' is none", name),
          "use guess, kitti, tum or ufes");
  return found->second;
}

std::vector<Lap> ReadLaps(const fs::path& folder, Format format) {
  Require(fs::exists(folder), folder.string(), "no such folder");
  if (!fs::is_directory(folder)) return {ReadTrajectoryFile(folder, format)};
  const auto wanted = [&](Format found) {
    return found != Format::kGuess && (format == Format::kGuess || format == found);
  };
  if (const Format found = FormatOf(folder); wanted(found)) return ReadFolder(folder, found);

  std::vector<fs::path> inner;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const bool hidden = entry.path().filename().string().front() == '.';  // a lap being written
    if (entry.is_directory() && !hidden && wanted(FormatOf(entry.path()))) {
      inner.push_back(entry.path());
    }
  }
  std::sort(inner.begin(), inner.end());
  std::vector<Lap> laps;
  for (const fs::path& path : inner) {
    for (Lap& lap : ReadFolder(path, FormatOf(path))) laps.push_back(std::move(lap));
  }
  Require(!laps.empty(), folder.string(), "holds no lap that can be recognised",
          "a lap has calib.txt and poses.txt (KITTI), rgb.txt and groundtruth.txt (TUM), or "
          "camera3.txt and camerapos-*.txt (UFES-LAPS)");
  return laps;
}

Lap ReadLap(const fs::path& folder, Format format) {
  std::vector<Lap> laps = ReadLaps(folder, format);
  Require(laps.size() == 1, folder.string(),
          fmt::format("holds {} laps where one is wanted", laps.size()), "name one of them");
  return std::move(laps.front());
}

}  // namespace recollect
