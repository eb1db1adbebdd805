#include "recollect/testing/street.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "recollect/core/error.h"
#include "recollect/core/files.h"
#include "recollect/core/random.h"
#include "recollect/dataset/reader.h"

namespace recollect::testing {
namespace {

constexpr double kHalfWidth = 6, kHeight = 7, kCameraHeight = 1.6, kHouse = 6;
const PinholeCamera kCamera{320, 240, 245, 245, 159.5, 119.5};

double HashToUnit(std::int64_t x, std::int64_t y, std::uint64_t layer) {
  const auto key = static_cast<std::uint64_t>(x) * 0x9e3779b1u + static_cast<std::uint64_t>(y);
  return static_cast<double>(SubSeed(layer, key) >> 11) * 0x1.0p-53;
}

double Noise(double x, double y, std::uint64_t layer) {
  const double fx = std::floor(x), fy = std::floor(y);
  const auto ix = static_cast<std::int64_t>(fx), iy = static_cast<std::int64_t>(fy);
  const auto row = [&](std::int64_t j) {
    return std::lerp(HashToUnit(ix, j, layer), HashToUnit(ix + 1, j, layer), x - fx);
  };
  return std::lerp(row(iy), row(iy + 1), y - fy) - 0.5;
}

// Octaves of noise, the finer ones fading where a pixel is wider than they are.
double Texture(double x, double y, double pixel_m, std::uint64_t layer) {
  double value = 0;
  for (int octave = 0; octave < 6; ++octave) {
    const double scale = std::ldexp(1.0, octave);
    value += Noise(x * scale, y * scale, layer + static_cast<std::uint64_t>(octave)) /
             std::sqrt(scale) * std::clamp(1 / (2 * pixel_m * scale), 0.0, 1.0);
  }
  return value;
}

// Colour of a house front `along` the street and `up` the wall.
cv::Vec3d HouseColour(double along, double up, double pixel_m, std::uint64_t side) {
  const auto house = static_cast<std::int64_t>(std::floor(along / kHouse));
  const double pitch = 1 + 1.5 * HashToUnit(house, 1, side);
  const double within = along - kHouse * static_cast<double>(house);
  const double wx = std::fmod(within, pitch) / pitch, wy = std::fmod(up, 2.3) / 2.3;
  const bool window =
      wx > 0.25 && wx < 0.4 + 0.4 * HashToUnit(house, 2, side) && wy > 0.3 && wy < 0.75;
  cv::Vec3d colour;
  for (int c = 0; c < 3; ++c) {
    const double paint = 60 + 150 * HashToUnit(house, 3 + c, side);
    colour[c] = window ? 0.3 * paint : paint;
  }
  const double grain = 1 + 0.6 * Texture(along, up, pixel_m, side + 100);
  return colour * grain;
}

struct Hit {
  double depth = 0;  // along the camera's z, metres; 0: sky
  cv::Vec3d colour{230, 200, 170};
};

Hit Cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray, double length_m) {
  Hit hit;
  double nearest = 1e9;
  const auto consider = [&](double t, const auto& colour_at) {
    if (t <= 0.1 || t >= nearest) return;
    const Eigen::Vector3d p = origin + t * ray;
    if (p.z() < -1e-6 || p.z() > kHeight || std::abs(p.y()) > kHalfWidth + 1e-6) return;
    nearest = t;
    hit = {t, colour_at(p, t / kCamera.fx)};
  };
  consider(-origin.z() / ray.z(), [](const Eigen::Vector3d& p, double pixel_m) {
    const double gray = 95 * (1 + 0.7 * Texture(p.x(), p.y(), 4 * pixel_m, 7));
    return cv::Vec3d(gray, gray, gray);
  });
  for (const double side : {-1.0, 1.0}) {
    consider((side * kHalfWidth - origin.y()) / ray.y(),
             [&](const Eigen::Vector3d& p, double pixel_m) {
               return HouseColour(p.x(), p.z(), pixel_m, side > 0 ? 11 : 12);
             });
  }
  consider((length_m + 30 - origin.x()) / ray.x(), [](const Eigen::Vector3d& p, double pixel_m) {
    return HouseColour(p.y() + 100, p.z(), pixel_m, 13);
  });
  return hit;
}

}  // namespace

Lap DriveStreet(const std::filesystem::path& folder, const StreetDrive& drive) {
  std::filesystem::create_directories(folder / "image_2");
  std::filesystem::create_directories(folder / "depth");
  Eigen::Matrix3d ahead;  // columns: the camera's x, y, z in the world
  ahead << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  Random random(drive.seed);
  std::string poses, times;
  const int frames = static_cast<int>(drive.length_m / drive.spacing_m);
  for (int i = 0; i < frames; ++i) {
    const Eigen::Vector3d wobble =
        drive.wobble_rad * Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal());
    const SE3 world_from_camera(ahead * ExpSo3(wobble),
                                {i * drive.spacing_m, drive.lateral_m, kCameraHeight});
    cv::Mat image(kCamera.height, kCamera.width, CV_8UC3);
    cv::Mat depth(kCamera.height / 2, kCamera.width / 2, CV_16UC1);
    for (int v = 0; v < kCamera.height; ++v) {
      for (int u = 0; u < kCamera.width; ++u) {
        const Eigen::Vector3d ray = world_from_camera.rotation() * kCamera.Unproject(u, v, 1);
        const Hit hit = Cast(world_from_camera.translation(), ray, drive.length_m);
        image.at<cv::Vec3b>(v, u) = cv::Vec3b(drive.brightness * hit.colour);
        if (u % 2 == 0 && v % 2 == 0) {
          depth.at<std::uint16_t>(v / 2, u / 2) =
              static_cast<std::uint16_t>(std::lround(100 * hit.depth));
        }
      }
    }
    cv::imwrite((folder / "image_2" / fmt::format("{:06}.png", i)).string(), image);
    cv::imwrite((folder / "depth" / fmt::format("{:06}.png", i)).string(), depth);
    const Eigen::Matrix4d m = world_from_camera.Matrix();
    for (int k = 0; k < 12; ++k)
      poses += fmt::format("{:.9f}{}", m(k / 4, k % 4), k < 11 ? ' ' : '\n');
    times += fmt::format("{:.3f}\n", 0.1 * i);
  }
  AtomicWrite(folder / "poses.txt", poses);
  AtomicWrite(folder / "times.txt", times);
  AtomicWrite(folder / "calib.txt", fmt::format("P2: {} 0 {} 0 0 {} {} 0 0 0 1 0\n", kCamera.fx,
                                                kCamera.cx, kCamera.fy, kCamera.cy));
  return ReadLap(folder);
}

}  // namespace recollect::testing
