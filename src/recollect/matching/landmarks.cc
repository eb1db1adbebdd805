#include "recollect/matching/landmarks.h"

#include <cmath>
#include <cstring>

#include "recollect/core/error.h"
#include "recollect/matching/features.h"

namespace recollect::matching {
namespace {

constexpr std::uint32_t kMagic = 0x314d4752;  // "RGM1"
constexpr std::uint32_t kMaxCount = 1 << 20;

struct Head {
  std::uint32_t magic, points, sources;
};
struct Record {
  float p[3], pixel_sigma, depth_sigma;
};
static_assert(sizeof(Head) == 12 && sizeof(Record) == 20);

}  // namespace

Eigen::Matrix3d Landmark::Covariance(const PinholeCamera& camera) const {
  const double z = p_keyframe.z();
  const Eigen::Vector3d along = p_keyframe / z;  // what one metre of depth moves it
  const double across_x = z * pixel_sigma / camera.fx, across_y = z * pixel_sigma / camera.fy;
  Eigen::Matrix3d covariance = depth_sigma * depth_sigma * along * along.transpose();
  covariance(0, 0) += across_x * across_x;
  covariance(1, 1) += across_y * across_y;
  return covariance;
}

std::vector<std::byte> ToBytes(const Landmarks& landmarks) {
  const Head head{kMagic, static_cast<std::uint32_t>(landmarks.size()),
                  static_cast<std::uint32_t>(landmarks.sources.size())};
  std::vector<std::byte> bytes(sizeof(head));
  std::memcpy(bytes.data(), &head, sizeof(head));
  const auto append = [&](const void* data, std::size_t size) {
    const auto* from = static_cast<const std::byte*>(data);
    bytes.insert(bytes.end(), from, from + size);
  };
  for (const Landmark& l : landmarks.points) {
    const Eigen::Vector3f p = l.p_keyframe.cast<float>();
    const Record record{{p.x(), p.y(), p.z()},
                        static_cast<float>(l.pixel_sigma),
                        static_cast<float>(l.depth_sigma)};
    append(&record, sizeof(record));
  }
  for (const int source : landmarks.sources) {
    const auto frame = static_cast<std::int32_t>(source);
    append(&frame, sizeof(frame));
  }
  append(landmarks.descriptors.data(), landmarks.descriptors.size());
  return bytes;
}

Landmarks LandmarksFromBytes(std::span<const std::byte> bytes, const std::string& where) {
  const char* remedy = "create the map again";
  Head head{};
  Require(bytes.size() >= sizeof(head), where, "its geometry is cut short", remedy);
  std::memcpy(&head, bytes.data(), sizeof(head));
  Require(head.magic == kMagic, where, "its geometry is of another format", remedy);
  Require(head.points <= kMaxCount && head.sources <= kMaxCount &&
              bytes.size() == sizeof(head) + head.points * (sizeof(Record) + kDescriptorBytes) +
                                  head.sources * sizeof(std::int32_t),
          where, "its geometry has a wrong size", remedy);
  Landmarks landmarks;
  const std::byte* at = bytes.data() + sizeof(head);
  for (std::uint32_t i = 0; i < head.points; ++i, at += sizeof(Record)) {
    Record record;
    std::memcpy(&record, at, sizeof(record));
    const Landmark l{
        {record.p[0], record.p[1], record.p[2]}, record.pixel_sigma, record.depth_sigma};
    Require(l.p_keyframe.allFinite() && l.p_keyframe.z() > 0 && l.pixel_sigma > 0 &&
                l.depth_sigma >= 0 && std::isfinite(l.pixel_sigma + l.depth_sigma),
            where, "its geometry has an impossible point", remedy);
    landmarks.points.push_back(l);
  }
  for (std::uint32_t i = 0; i < head.sources; ++i, at += sizeof(std::int32_t)) {
    std::int32_t frame = 0;
    std::memcpy(&frame, at, sizeof(frame));
    landmarks.sources.push_back(frame);
  }
  const auto* descriptors = reinterpret_cast<const std::int8_t*>(at);
  landmarks.descriptors.assign(descriptors, descriptors + head.points * kDescriptorBytes);
  return landmarks;
}

}  // namespace recollect::matching
