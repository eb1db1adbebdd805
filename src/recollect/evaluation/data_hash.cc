#include "recollect/evaluation/data_hash.h"

#include "recollect/core/error.h"
#include "recollect/core/files.h"

namespace recollect {
namespace {

void AddFile(const std::filesystem::path& file, Hash& hash) {
  if (file.empty()) return;
  std::error_code error;
  const auto bytes = std::filesystem::file_size(file, error);
  Require(!error, file.string(), fmt::format("cannot be read ({})", error.message()));
  hash.Add(fmt::format("{} {}\n", file.filename().string(), bytes));
}

std::string Text(const Eigen::Vector3d& v) {
  return fmt::format("{} {} {}\n", v.x(), v.y(), v.z());
}

std::string Text(const SE3& pose) {
  std::string text = Text(pose.translation());
  for (int row = 0; row < 3; ++row) text += Text(Eigen::Vector3d(pose.rotation().row(row)));
  return text;
}

}  // namespace

Hash& Hash::Add(std::string_view bytes) {
  for (const char byte : bytes) {
    state_ = (state_ ^ static_cast<unsigned char>(byte)) * 0x100000001b3ULL;
  }
  return *this;
}

std::string Hash::Text() const { return fmt::format("{:016x}", state_); }

std::string HashOfFile(const std::filesystem::path& file) {
  return Hash().Add(ReadFile(file)).Text();
}

std::string HashOf(const std::vector<Lap>& laps) {
  Hash hash;
  for (const Lap& lap : laps) {
    const PinholeCamera& c = lap.camera.left;
    hash.Add(fmt::format("{} {} {} {} {} {} {} {}\n", lap.name, c.width, c.height, c.fx, c.fy, c.cx,
                         c.cy, lap.camera.baseline));
    hash.Add(Text(lap.body_from_camera));
    for (const Frame& frame : lap.frames) {
      hash.Add(fmt::format("{} ", frame.time)).Add(Text(frame.world_from_body));
      for (const auto& file : {frame.left, frame.right, frame.depth}) AddFile(file, hash);
    }
    for (const GpsFix& fix : lap.gps) {
      hash.Add(fmt::format("{} {} ", fix.time, fix.quality)).Add(Text(fix.p_world));
    }
  }
  return hash.Text();
}

}  // namespace recollect
