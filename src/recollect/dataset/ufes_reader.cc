#include "recollect/dataset/ufes_reader.h"

#include <algorithm>
#include <array>
#include <set>

#include "recollect/core/error.h"
#include "recollect/dataset/text_table.h"
#include "recollect/geometry/frames.h"

namespace recollect {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPosePrefix = "camerapos-";
constexpr int kWidth = 640, kHeight = 480;

bool IsPoseFile(const fs::path& path) {
  return path.extension() == ".txt" && path.filename().string().starts_with(kPosePrefix);
}

StereoCamera ReadCamera(const fs::path& path) {
  const TextTable table(path, ',');
  Require(table.rows().size() == 1, path.string(),
          fmt::format("{} rows of numbers where 1 belongs", table.rows().size()));
  const TextTable::Row& row = table.rows().front();
  table.RequireFields(row, 5, "fx,cx,fy,cy,baseline");
  const double fx = table.Number(row, 0), fy = table.Number(row, 2);
  const double baseline = table.Number(row, 4);
  if (fx <= 0 || fy <= 0) table.Fail(row, "focal length is not positive");
  if (baseline <= 0) table.Fail(row, "baseline is not positive");
  return {{kWidth, kHeight, fx * kWidth, fy * kHeight, table.Number(row, 1) * kWidth,
           table.Number(row, 3) * kHeight},
          baseline};
}

// The names of the files in a folder; none where there is no such folder.
std::set<std::string> FileNames(const fs::path& folder) {
  std::set<std::string> names;
  if (!fs::is_directory(folder)) return names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    names.insert(entry.path().filename().string());
  }
  return names;
}

void ReadPoses(const fs::path& path, Lap& lap) {
  const TextTable table(path);
  const fs::path image_folder = path.parent_path() / lap.name;
  const std::set<std::string> images = FileNames(image_folder);
  const auto image = [&](std::string_view recorded_path) {
    const std::string name = fs::path(recorded_path).filename().string();
    return images.contains(name) ? image_folder / name : fs::path();
  };
  for (const TextTable::Row& row :
       table.RowsAfterHeader("x y z rx ry rz timestamp left_image right_image")) {
    const std::array<double, 7> v = table.Numbers<7>(row);
    Frame frame;
    frame.time = v[6];
    frame.world_from_body = SE3(RotationFromRollPitchYaw(v[3], v[4], v[5]), {v[0], v[1], v[2]});
    frame.left = image(row.fields[7]);
    frame.right = image(row.fields[8]);
    if (!lap.frames.empty()) table.RequireAfter(row, lap.frames.back().time, frame.time);
    lap.frames.push_back(std::move(frame));
  }
  Require(!lap.frames.empty(), path.string(), "holds no pose");
}

void ReadGps(const fs::path& path, Lap& lap) {
  const TextTable table(path);
  for (const TextTable::Row& row : table.RowsAfterHeader("x y z heading valid quality timestamp")) {
    const std::array<double, 7> v = table.Numbers<7>(row);
    if (!lap.gps.empty()) table.RequireAfter(row, lap.gps.back().time, v[6]);
    lap.gps.push_back({v[6], {v[0], v[1], v[2]}, table.Quality(row, 5)});
  }
}

}  // namespace

bool LooksLikeUfes(const fs::path& folder) {
  return std::any_of(fs::directory_iterator(folder), fs::directory_iterator(),
                     [](const fs::directory_entry& entry) { return IsPoseFile(entry.path()); });
}

std::vector<Lap> ReadUfesLaps(const fs::path& folder) {
  const StereoCamera camera = ReadCamera(folder / "camera3.txt");
  std::vector<Lap> laps;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (!IsPoseFile(entry.path())) continue;
    Lap& lap = laps.emplace_back();
    lap.name = entry.path().stem().string().substr(kPosePrefix.size());
    lap.folder = folder;
    lap.camera = camera;
    lap.body_from_camera = UfesVehicleFromCamera();
    lap.body_forward = Eigen::Vector3d::UnitX();
    lap.world_up = Eigen::Vector3d::UnitZ();
    ReadPoses(entry.path(), lap);
    const fs::path gps = folder / fmt::format("cameragps-{}.txt", lap.name);
    if (fs::exists(gps)) ReadGps(gps, lap);
  }
  std::sort(laps.begin(), laps.end(), [](const Lap& a, const Lap& b) { return a.name < b.name; });
  return laps;
}

}  // namespace recollect
