#include "recollect/simulation/lap_writer.h"

#include <opencv2/imgcodecs.hpp>
#include <utility>

#include "recollect/core/error.h"
#include "recollect/core/files.h"

namespace recollect::simulation {
namespace fs = std::filesystem;
namespace {

constexpr const char* kDescription = "lap.txt";

void RequireSame(const fs::path& folder, const std::string& description) {
  const std::string other = ReadFile(folder / kDescription);
  Require(other == description, folder.string(),
          "was made with other options or by another version",
          "remove it or choose another folder");
}

void WriteImage(const fs::path& path, const cv::Mat& image, const std::vector<int>& options) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(path.extension().string(), image, bytes, options);
  AtomicWrite(path, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

}  // namespace

LapWriter::LapWriter(fs::path out, std::string name, std::string description, bool stereo,
                     bool depth)
    : folder_(out / name), work_(out / ("." + name + ".partial")), stereo_(stereo), depth_(depth) {
  if (fs::exists(folder_)) {
    Require(fs::exists(folder_ / kDescription), folder_.string(), "is there and no simulated lap",
            "choose another folder");
    RequireSame(folder_, description);
    finished_ = true;
    return;
  }
  if (fs::exists(work_ / kDescription)) {
    RequireSame(work_, description);
  } else {
    AtomicWrite(work_ / kDescription, description);
  }
  std::error_code error;
  for (const char* kind : {"image_2", "image_3", "depth"})
    fs::create_directories(work_ / kind, error);
  Require(!error, work_.string(), fmt::format("cannot be made ({})", error.message()));
}

fs::path LapWriter::Path(const char* kind, std::int64_t frame, const char* extension) const {
  return work_ / kind / fmt::format("{:06}.{}", frame, extension);
}

bool LapWriter::Has(std::int64_t frame) const {
  return finished_ || (fs::exists(Path("image_2", frame, "jpg")) &&
                       (!stereo_ || fs::exists(Path("image_3", frame, "jpg"))) &&
                       (!depth_ || fs::exists(Path("depth", frame, "png"))));
}

void LapWriter::Write(std::int64_t frame, const cv::Mat& left, const cv::Mat& right,
                      const cv::Mat& depth, int jpeg_quality) {
  const std::vector<int> jpeg = {cv::IMWRITE_JPEG_QUALITY, jpeg_quality};
  if (!right.empty()) WriteImage(Path("image_3", frame, "jpg"), right, jpeg);
  if (!depth.empty())
    WriteImage(Path("depth", frame, "png"), depth, {cv::IMWRITE_PNG_COMPRESSION, 1});
  WriteImage(Path("image_2", frame, "jpg"), left, jpeg);
}

void LapWriter::WriteText(const std::string& file, const std::string& text) {
  AtomicWrite(work_ / file, text);
}

void LapWriter::Finish() {
  if (finished_) return;
  std::error_code error;
  if (!stereo_) fs::remove(work_ / "image_3", error);
  if (!depth_) fs::remove(work_ / "depth", error);
  fs::rename(work_, folder_, error);
  Require(!error, folder_.string(), fmt::format("cannot be put in place ({})", error.message()));
  finished_ = true;
}

std::string KittiPoses(const std::vector<SE3>& poses) {
  std::string text;
  for (const SE3& pose : poses) {
    const Eigen::Matrix4d m = pose.Matrix();
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 4; ++c) text += fmt::format("{}{:.9f}", r + c > 0 ? " " : "", m(r, c));
    }
    text += '\n';
  }
  return text;
}

std::string KittiCalibration(const StereoCamera& camera) {
  std::string text;
  const PinholeCamera& c = camera.left;
  for (int i = 0; i < 4; ++i) {
    const double shift = i % 2 == 1 ? -c.fx * camera.baseline : 0;
    text +=
        fmt::format("P{}: {} 0 {} {:.6f} 0 {} {} 0 0 0 1 0\n", i, c.fx, c.cx, shift, c.fy, c.cy);
  }
  return text;
}

std::string GpsTable(const std::vector<GpsFix>& fixes) {
  std::string text = "time,x,y,z,quality\n";
  for (const GpsFix& fix : fixes) {
    text += fmt::format("{:.4f},{:.3f},{:.3f},{:.3f},{}\n", fix.time, fix.p_world.x(),
                        fix.p_world.y(), fix.p_world.z(), fix.quality);
  }
  return text;
}

}  // namespace recollect::simulation
