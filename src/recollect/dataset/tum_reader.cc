#include "recollect/dataset/tum_reader.h"

#include <algorithm>
#include <cmath>

#include "recollect/core/error.h"
#include "recollect/dataset/image.h"
#include "recollect/dataset/image_checks.h"
#include "recollect/dataset/text_table.h"
#include "recollect/dataset/trajectory_io.h"

namespace recollect {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxTimeDifference = 0.02;  // seconds; that of the benchmark's own tools
constexpr double kDepthUnit = 1.0 / 5000;
constexpr PinholeCamera kDefaultCamera{640, 480, 525, 525, 319.5, 239.5};

struct ListedImage {
  double time = 0;
  fs::path path;
};

std::vector<ListedImage> ReadList(const fs::path& list) {
  const TextTable table(list);
  std::vector<ListedImage> images;
  for (const TextTable::Row& row : table.rows()) {
    table.RequireFields(row, 2, "time and file");
    const double time = table.Number(row, 0);
    if (!images.empty()) table.RequireAfter(row, images.back().time, time);
    const fs::path path = list.parent_path() / row.fields[1];
    if (!fs::is_regular_file(path)) {
      table.Fail(row, fmt::format("there is no file {}", row.fields[1]));
    }
    images.push_back({time, path});
  }
  Require(!images.empty(), list.string(), "lists no image");
  return images;
}

PinholeCamera ReadCamera(const fs::path& folder, const fs::path& first_image) {
  const ImageInfo info = ReadImageInfo(first_image);
  const fs::path path = folder / "calibration.txt";
  if (!fs::exists(path)) {
    Require(info.width == kDefaultCamera.width && info.height == kDefaultCamera.height,
            folder.string(),
            fmt::format("{}x{} images have no default camera", info.width, info.height),
            "add calibration.txt with fx fy cx cy");
    return kDefaultCamera;
  }
  const TextTable table(path);
  Require(table.rows().size() == 1, path.string(),
          fmt::format("{} rows of numbers where 1 belongs", table.rows().size()));
  const TextTable::Row& row = table.rows().front();
  table.RequireFields(row, 4, "fx fy cx cy");
  const auto [fx, fy, cx, cy] = table.Numbers<4>(row);
  if (fx <= 0 || fy <= 0) table.Fail(row, "focal length is not positive");
  return {info.width, info.height, fx, fy, cx, cy};
}

// The entry nearest in time, the end of the list where none is within the allowed difference.
template <typename Entries>
auto Nearest(const Entries& entries, double time) {
  const auto after =
      std::lower_bound(entries.begin(), entries.end(), time,
                       [](const auto& entry, double wanted) { return entry.time < wanted; });
  auto nearest = after;
  if (after != entries.begin() &&
      (after == entries.end() || time - (after - 1)->time <= after->time - time)) {
    nearest = after - 1;
  }
  const bool near =
      nearest != entries.end() && std::abs(nearest->time - time) <= kMaxTimeDifference;
  return near ? nearest : entries.end();
}

}  // namespace

bool LooksLikeTum(const fs::path& folder) {
  return fs::exists(folder / "rgb.txt") || fs::exists(folder / "groundtruth.txt");
}

Lap ReadTumLap(const fs::path& folder) {
  const std::vector<ListedImage> images = ReadList(folder / "rgb.txt");
  const fs::path depth_list = folder / "depth.txt";
  const auto depths = fs::exists(depth_list) ? ReadList(depth_list) : std::vector<ListedImage>{};
  const Trajectory truth = ReadTumTrajectory(folder / "groundtruth.txt");

  Lap lap;
  lap.folder = folder;
  lap.name = fs::canonical(folder).filename().string();
  lap.camera.left = ReadCamera(folder, images.front().path);
  lap.depth_unit = kDepthUnit;
  for (const ListedImage& depth : depths) RequireDepth(depth.path, lap.camera.left);
  for (const ListedImage& image : images) {
    RequireSize(image.path, lap.camera.left);
    const auto pose = Nearest(truth.poses(), image.time);
    if (pose == truth.poses().end()) continue;
    Frame& frame = lap.frames.emplace_back();
    frame.time = image.time;
    frame.world_from_body = truth.Covers(image.time) ? truth.At(image.time) : pose->world_from_body;
    frame.left = image.path;
    const auto depth = Nearest(depths, image.time);
    if (depth != depths.end()) frame.depth = depth->path;
  }
  Require(!lap.frames.empty(), folder.string(),
          fmt::format("no image of rgb.txt is within {} s of a pose of groundtruth.txt",
                      kMaxTimeDifference));
  return lap;
}

}  // namespace recollect
