#include "recollect/evaluation/data_hash.h"

#include <fstream>

#include "recollect/core/error.h"

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
  std::ifstream in(file, std::ios::binary);
  Require(in.is_open(), file.string(), "cannot be read");
  Hash hash;
  std::string piece(1 << 20, '\0');  // maps are large
  while (in) {
    in.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    hash.Add(std::string_view(piece).substr(0, static_cast<std::size_t>(in.gcount())));
  }
  Require(in.eof(), file.string(), "cannot be read");
  return hash.Text();
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
