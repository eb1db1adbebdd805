#include "recollect/simulation/film.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "recollect/core/random.h"

namespace recollect::simulation {
namespace {

constexpr int kBlock = 4;      // pixels that share a motion vector, either way
constexpr int kMostTaps = 12;  // along that vector
constexpr float kFarthest = 200;

// Samples of a normal distribution, drawn once: a random index gives a random number.
const std::array<float, 4096>& Bells() {
  static const std::array<float, 4096> bells = [] {
    std::array<float, 4096> table{};
    Random random(0xbe11);
    for (float& x : table) x = static_cast<float>(random.Normal());
    return table;
  }();
  return bells;
}

// Averages each pixel along the path that its point takes in the image during the exposure.
std::vector<Color> Blur(const Rendering& r, const PinholeCamera& camera,
                        const SE3& start_from_end) {
  std::vector<Color> out = r.radiance;
  const SE3 end_from_start = start_from_end.Inverse();
  for (int by = 0; by < r.height; by += kBlock) {
    for (int bx = 0; bx < r.width; bx += kBlock) {
      const int cx = std::min(bx + kBlock / 2, r.width - 1),
                cy = std::min(by + kBlock / 2, r.height - 1);
      const float depth = r.Depth(cx, cy);
      const Eigen::Vector3d p =
          camera.Unproject(cx, cy, depth > 0 ? static_cast<double>(depth) : 1e5);
      const Eigen::Vector3d q = end_from_start * p;
      if (q.z() < 0.1) continue;
      const Eigen::Vector2f move = (camera.Project(q) - Eigen::Vector2d(cx, cy)).cast<float>();
      const int taps = std::min(kMostTaps, static_cast<int>(move.norm() + 0.5F) + 1);
      if (taps < 2) continue;
      std::array<std::array<int, 2>, kMostTaps> path;
      for (int k = 0; k < taps; ++k) {
        const float t = (static_cast<float>(k) + 0.5F) / static_cast<float>(taps) - 0.5F;
        path[static_cast<std::size_t>(k)] = {static_cast<int>(std::lround(t * move.x())),
                                             static_cast<int>(std::lround(t * move.y()))};
      }
      for (int y = by; y < std::min(by + kBlock, r.height); ++y) {
        for (int x = bx; x < std::min(bx + kBlock, r.width); ++x) {
          Color sum = Color::Zero();
          for (int k = 0; k < taps; ++k) {
            const int sx = x + path[static_cast<std::size_t>(k)][0];
            const int sy = y + path[static_cast<std::size_t>(k)][1];
            sum += r.At(std::clamp(sx, 0, r.width - 1), std::clamp(sy, 0, r.height - 1));
          }
          out[r.Index(x, y)] = sum / static_cast<float>(taps);
        }
      }
    }
  }
  return out;
}

}  // namespace

Film LoadFilm(const Day& day) {
  Film film;
  if (!day.change.light) return film;
  const auto vary = [&](std::uint64_t key, double range) {
    const double u = 2 * day.Draw(key) - 1;
    return static_cast<float>(1 + std::min(day.change.strength, 3.0) * range * u);
  };
  film.brightness *= vary(31, 0.2);
  film.white_balance = Color(vary(32, 0.05), 1, vary(33, 0.06));
  return film;
}

cv::Mat Develop(const Rendering& r, const PinholeCamera& camera, const SE3& start_from_end,
                const Film& film, std::uint64_t seed, float extra_gain) {
  const std::vector<Color> light = Blur(r, camera, start_from_end);
  double sum = 0;
  for (const Color& c : light) sum += static_cast<double>(std::min(2.5F, c.mean()));
  const double mean = sum / static_cast<double>(light.size());
  const float gain = extra_gain * static_cast<float>(std::min(
                                      static_cast<double>(film.longest_gain),
                                      static_cast<double>(film.brightness) / std::max(mean, 1e-6)));
  constexpr int kTones = 4096;
  std::array<std::uint8_t, kTones + 1> tone{};
  std::array<float, kTones + 1> noise{};  // its standard deviation
  for (int i = 0; i <= kTones; ++i) {
    const float v = static_cast<float>(i) / kTones;
    tone[static_cast<std::size_t>(i)] =
        static_cast<std::uint8_t>(std::lround(255 * std::pow(v, 1 / film.gamma)));
    noise[static_cast<std::size_t>(i)] =
        std::sqrt(film.read_noise * film.read_noise + film.shot_noise * film.shot_noise * v);
  }
  const auto& bells = Bells();
  const Color scale = film.white_balance * gain;
  const float half = static_cast<float>(std::hypot(r.width, r.height)) / 2;
  cv::Mat3b image(r.height, r.width);
  for (int y = 0; y < r.height; ++y) {
    for (int x = 0; x < r.width; ++x) {
      const float dx = (static_cast<float>(x) - static_cast<float>(r.width) / 2) / half;
      const float dy = (static_cast<float>(y) - static_cast<float>(r.height) / 2) / half;
      const Color c = light[r.Index(x, y)] * scale * (1 - film.vignette * (dx * dx + dy * dy));
      cv::Vec3b& pixel = image(y, x);
      const std::uint64_t grain = SubSeed(seed, r.Index(x, y));
      for (int k = 0; k < 3; ++k) {
        // Highlights bend over softly towards white; then photons and electronics add their noise.
        const float v = std::min(1.0F, c[k] * 1.2F / (1 + 0.35F * c[k]));
        const float noisy = v + bells[(grain >> (16 * k)) % bells.size()] *
                                    noise[static_cast<std::size_t>(v * kTones)];
        const int level = static_cast<int>(std::clamp(noisy, 0.0F, 1.0F) * kTones);
        pixel[2 - k] = tone[static_cast<std::size_t>(level)];
      }
    }
  }
  return image;
}

cv::Mat DepthImage(const Rendering& r, int step) {
  cv::Mat1w image((r.height + step - 1) / step, (r.width + step - 1) / step);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const float depth = r.Depth(x * step, y * step);
      image(y, x) = depth > 0 && depth < kFarthest ? static_cast<std::uint16_t>(depth * 100 + 0.5F)
                                                   : std::uint16_t{0};
    }
  }
  return image;
}

}  // namespace recollect::simulation
