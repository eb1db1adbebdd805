#include "recollect/dataset/kitti_reader.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <charconv>
#include <map>

#include "recollect/core/error.h"
#include "recollect/dataset/image.h"
#include "recollect/dataset/image_checks.h"
#include "recollect/dataset/text_table.h"
#include "recollect/dataset/trajectory_io.h"

namespace recollect {
namespace {

namespace fs = std::filesystem;

using Projection = Eigen::Matrix<double, 3, 4>;
using NumberedFiles = std::map<std::int64_t, fs::path>;

// The images of a folder by the number that is their name.
NumberedFiles ListImages(const fs::path& folder) {
  NumberedFiles images;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string stem = entry.path().stem().string();
    const std::string extension = entry.path().extension().string();
    if (extension != ".png" && extension != ".jpg") continue;
    if (stem.starts_with('.')) continue;  // left over from a write that was cut short
    std::int64_t number = 0;
    const auto [end, code] = std::from_chars(stem.data(), stem.data() + stem.size(), number);
    Require(code == std::errc() && end == stem.data() + stem.size() && number >= 0,
            entry.path().string(), "the name of an image must be its number");
    Require(images.emplace(number, entry.path()).second, entry.path().string(),
            fmt::format("a second image with number {}", number));
  }
  return images;
}

Projection ReadMatrix(const TextTable& table, const TextTable::Row& row, std::size_t first) {
  const std::array<double, 12> values = table.Numbers<12>(row, first);
  return Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(values.data());
}

Projection ReadProjection(const TextTable& table, const TextTable::Row& row, std::size_t first) {
  const Projection P = ReadMatrix(table, row, first);
  if (P(0, 0) <= 0 || P(1, 1) <= 0) table.Fail(row, "focal length is not positive");
  Eigen::Matrix3d K = P.leftCols<3>();
  K(0, 0) = K(1, 1) = K(0, 2) = K(1, 2) = 0;
  K(2, 2) -= 1;
  if (!K.isZero(1e-9)) table.Fail(row, "projection is not that of a rectified camera");
  return P;
}

// P0..P3 by number, as far as the file has them.
std::map<int, Projection> ReadCalibration(const fs::path& path) {
  const TextTable table(path);
  std::map<int, Projection> projections;
  int bare_rows = 0;
  for (const TextTable::Row& row : table.rows()) {
    const std::string_view key = row.fields.front();
    const bool named = key.ends_with(':');
    if (named && (key.size() != 3 || key[0] != 'P')) continue;  // Tr: and the like
    table.RequireFields(row, named ? 13 : 12, named ? "a name and a 3x4 matrix" : "a 3x4 matrix");
    const int number = named ? key[1] - '0' : bare_rows++;
    if (!projections.emplace(number, ReadProjection(table, row, named ? 1 : 0)).second) {
      table.Fail(row, fmt::format("P{} is given twice", number));
    }
  }
  return projections;
}

std::vector<double> ReadTimes(const fs::path& path) {
  const TextTable table(path);
  std::vector<double> times;
  for (const TextTable::Row& row : table.rows()) {
    table.RequireFields(row, 1, "seconds");
    const double time = table.Number(row, 0);
    if (!times.empty()) table.RequireAfter(row, times.back(), time);
    times.push_back(time);
  }
  return times;
}

std::vector<GpsFix> ReadGps(const fs::path& path) {
  const TextTable table(path, ',');
  std::vector<GpsFix> fixes;
  for (const TextTable::Row& row : table.RowsAfterHeader("time x y z quality")) {
    const std::array<double, 4> v = table.Numbers<4>(row);
    if (!fixes.empty()) table.RequireAfter(row, fixes.back().time, v[0]);
    fixes.push_back({v[0], {v[1], v[2], v[3]}, table.Quality(row, 4)});
  }
  return fixes;
}

// The camera pair of the images `left` (0 or 2), and body_from_camera.
void SetCamera(const fs::path& calibration, int left, bool has_right, Lap& lap) {
  const std::map<int, Projection> projections = ReadCalibration(calibration);
  const auto P_of = [&](int number) {
    Require(projections.contains(number), calibration.string(),
            fmt::format("P{} is missing", number),
            fmt::format("image_{} needs its projection", number));
    return projections.at(number);
  };
  const Projection P = P_of(left);
  lap.camera.left.fx = P(0, 0);
  lap.camera.left.fy = P(1, 1);
  lap.camera.left.cx = P(0, 2);
  lap.camera.left.cy = P(1, 2);
  // P = K [I | t] takes a point of camera 0, the body, to this camera's pixels.
  const Eigen::Vector3d t = P.leftCols<3>().inverse() * P.col(3);
  lap.body_from_camera = SE3(Eigen::Matrix3d::Identity(), -t);
  if (has_right || projections.contains(left + 1)) {
    lap.camera.baseline = (P(0, 3) - P_of(left + 1)(0, 3)) / P(0, 0);
    Require(lap.camera.baseline > 0 || !has_right, calibration.string(),
            fmt::format("camera {} is not to the right of camera {}", left + 1, left));
    lap.camera.baseline = std::max(0.0, lap.camera.baseline);
  }
}

// Says which image is missing, where the numbers tell.
std::string Missing(const NumberedFiles& images, std::size_t count) {
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(count); ++i) {
    if (!images.contains(i)) return fmt::format("; the first missing is number {}", i);
  }
  return "";
}

// Frames with pose, time and left image.
std::vector<Frame> ReadFrames(const fs::path& folder, const fs::path& left_folder,
                              const NumberedFiles& left_images) {
  const std::vector<SE3> poses = ReadKittiPoses(folder / "poses.txt");
  Require(left_images.size() == poses.size(), left_folder.string(),
          fmt::format("{} images for the {} poses of poses.txt{}", left_images.size(), poses.size(),
                      Missing(left_images, poses.size())));
  const fs::path times_file = folder / "times.txt";
  std::vector<double> times;
  if (fs::exists(times_file)) {
    times = ReadTimes(times_file);
    Require(times.size() == poses.size(), times_file.string(),
            fmt::format("{} times for the {} poses of poses.txt", times.size(), poses.size()));
  }
  std::vector<Frame> frames(poses.size());
  for (std::size_t i = 0; const auto& [number, path] : left_images) {
    frames[i].time = times.empty() ? kKittiSecondsPerFrame * static_cast<double>(i) : times[i];
    frames[i].world_from_body = poses[i];
    frames[i].left = path;
    ++i;
  }
  return frames;
}

// Gives each image of a folder to the frame whose left image has its number.
void Attach(const fs::path& folder, const NumberedFiles& left_images, fs::path Frame::*image,
            std::vector<Frame>& frames) {
  if (!fs::exists(folder)) return;
  auto left = left_images.begin();
  std::size_t i = 0;
  for (const auto& [number, path] : ListImages(folder)) {
    for (; left != left_images.end() && left->first < number; ++left) ++i;
    Require(left != left_images.end() && left->first == number, path.string(),
            "no left image has that number");
    frames[i].*image = path;
  }
}

void CheckImages(const Lap& lap) {
  for (const Frame& frame : lap.frames) {
    RequireSize(frame.left, lap.camera.left);
    if (!frame.right.empty()) RequireSize(frame.right, lap.camera.left);
    if (!frame.depth.empty()) RequireDepth(frame.depth, lap.camera.left);
  }
}

}  // namespace

bool LooksLikeKitti(const fs::path& folder) {
  for (const char* mark : {"poses.txt", "calib.txt", "image_0", "image_2"}) {
    if (fs::exists(folder / mark)) return true;
  }
  return false;
}

StereoCamera ReadKittiStereo(const fs::path& calibration, int width, int height) {
  const std::map<int, Projection> projections = ReadCalibration(calibration);
  Lap lap;
  SetCamera(calibration, projections.contains(2) && projections.contains(3) ? 2 : 0, true, lap);
  lap.camera.left.width = width;
  lap.camera.left.height = height;
  return lap.camera;
}

Lap ReadKittiLap(const fs::path& folder) {
  Lap lap;
  lap.folder = folder;
  lap.name = fs::canonical(folder).filename().string();
  const int left = fs::exists(folder / "image_2") ? 2 : 0;
  const fs::path left_folder = folder / fmt::format("image_{}", left);
  const fs::path right_folder = folder / fmt::format("image_{}", left + 1);
  Require(fs::is_directory(left_folder), folder.string(), "has no images",
          "the left ones belong in image_2 (colour) or image_0 (gray)");
  const NumberedFiles left_images = ListImages(left_folder);
  Require(!left_images.empty(), left_folder.string(), "holds no image",
          "images are named NUMBER.png or NUMBER.jpg");
  SetCamera(folder / "calib.txt", left, fs::exists(right_folder), lap);
  const ImageInfo first = ReadImageInfo(left_images.begin()->second);
  lap.camera.left.width = first.width;
  lap.camera.left.height = first.height;
  lap.frames = ReadFrames(folder, left_folder, left_images);
  Attach(right_folder, left_images, &Frame::right, lap.frames);
  Attach(folder / "depth", left_images, &Frame::depth, lap.frames);
  CheckImages(lap);
  if (fs::exists(folder / "gps.csv")) lap.gps = ReadGps(folder / "gps.csv");
  return lap;
}

}  // namespace recollect
