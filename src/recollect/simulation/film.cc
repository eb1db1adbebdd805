#include "recollect/simulation/film.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "recollect/core/random.h"
#include "recollect/simulation/packet.h"

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

using Planes = std::array<std::vector<float>, 3>;

// Averages each pixel along the path that its point takes in the image during the exposure.
Planes Blur(const Rendering& r, const PinholeCamera& camera, const SE3& start_from_end) {
  Planes out = r.light;
  const SE3 end_from_start = start_from_end.Inverse();
  const Eigen::Matrix3f R = end_from_start.rotation().cast<float>();
  const Eigen::Vector3f t = end_from_start.translation().cast<float>();
  const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
  const auto cx = static_cast<float>(camera.cx), cy = static_cast<float>(camera.cy);
  for (int by = 0; by < r.height; by += kBlock) {
    for (int bx = 0; bx < r.width; bx += kBlock) {
      const int mx = std::min(bx + kBlock / 2, r.width - 1),
                my = std::min(by + kBlock / 2, r.height - 1);
      const float depth = r.Depth(mx, my) > 0 ? r.Depth(mx, my) : 1e5F;
      const float x0 = static_cast<float>(mx) - cx, y0 = static_cast<float>(my) - cy;
      const Eigen::Vector3f q = R * Eigen::Vector3f(x0 / fx, y0 / fy, 1) + t / depth;
      if (q.z() * depth < 0.1F) continue;
      const float dx = fx * q.x() / q.z() - x0, dy = fy * q.y() / q.z() - y0;
      const int taps =
          static_cast<int>(std::min(float{kMostTaps}, std::sqrt(dx * dx + dy * dy) + 1.5F));
      if (taps < 2) continue;
      std::array<int, kMostTaps> shift_x, shift_y;
      int low_x = bx, high_x = bx + kBlock, low_y = by, high_y = by + kBlock;
      for (std::size_t k = 0; k < static_cast<std::size_t>(taps); ++k) {
        const float s = (static_cast<float>(k) + 0.5F) / static_cast<float>(taps) - 0.5F;
        shift_x[k] = static_cast<int>(std::lround(s * dx));
        shift_y[k] = static_cast<int>(std::lround(s * dy));
        low_x = std::min(low_x, bx + shift_x[k]);
        high_x = std::max(high_x, bx + kBlock + shift_x[k]);
        low_y = std::min(low_y, by + shift_y[k]);
        high_y = std::max(high_y, by + kBlock + shift_y[k]);
      }
      const bool inside = low_x >= 0 && low_y >= 0 && high_x <= r.width && high_y <= r.height;
      const float share = 1 / static_cast<float>(taps);
      for (int y = by; y < std::min(by + kBlock, r.height); ++y) {
        for (std::size_t c = 0; c < 3; ++c) {
          const float* plane = r.light[c].data();
          if (inside) {
            std::array<float, kBlock> sum{};
            for (std::size_t k = 0; k < static_cast<std::size_t>(taps); ++k) {
              const float* from = plane + r.Index(bx + shift_x[k], y + shift_y[k]);
              for (std::size_t x = 0; x < kBlock; ++x) sum[x] += from[x];
            }
            float* to = &out[c][r.Index(bx, y)];
            for (std::size_t x = 0; x < kBlock; ++x) to[x] = sum[x] * share;
            continue;
          }
          for (int x = bx; x < std::min(bx + kBlock, r.width); ++x) {
            float sum = 0;
            for (std::size_t k = 0; k < static_cast<std::size_t>(taps); ++k) {
              sum += plane[r.Index(std::clamp(x + shift_x[k], 0, r.width - 1),
                                   std::clamp(y + shift_y[k], 0, r.height - 1))];
            }
            out[c][r.Index(x, y)] = sum * share;
          }
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
  const Planes light = Blur(r, camera, start_from_end);
  double sum = 0;
  for (std::size_t i = 0; i < light[0].size(); ++i) {
    sum += static_cast<double>(std::min(7.5F, light[0][i] + light[1][i] + light[2][i]));
  }
  const double mean = sum / 3 / static_cast<double>(light[0].size());
  const float gain = extra_gain * static_cast<float>(std::min(
                                      static_cast<double>(film.longest_gain),
                                      static_cast<double>(film.brightness) / std::max(mean, 1e-6)));
  constexpr int kTones = 4096;
  std::array<std::int32_t, kTones + 1> tone{};
  for (int i = 0; i <= kTones; ++i) {
    const float v = static_cast<float>(i) / kTones;
    tone[static_cast<std::size_t>(i)] =
        static_cast<std::int32_t>(std::lround(255 * std::pow(v, 1 / film.gamma)));
  }
  const float half = static_cast<float>(std::hypot(r.width, r.height)) / 2;
  const PacketKernel& kernel = *PacketKernels().front();
  cv::Mat3b image(r.height, r.width);
  FilmRow row{};
  row.width = r.width;
  row.across = 1 / half;
  row.vignette = film.vignette;
  row.read_noise = film.read_noise * film.read_noise;
  row.shot_noise = film.shot_noise * film.shot_noise;
  row.bells = Bells().data();
  row.tone = tone.data();
  for (int y = 0; y < r.height; ++y) {
    for (std::size_t c = 0; c < 3; ++c) {
      row.light[c] = &light[c][r.Index(0, y)];
      row.scale[c] = film.white_balance[static_cast<Eigen::Index>(c)] * gain;
    }
    row.along = (static_cast<float>(y) - static_cast<float>(r.height) / 2) / half;
    row.seed = static_cast<std::uint32_t>(SubSeed(seed, static_cast<std::uint64_t>(y)));
    row.out = image.ptr<std::uint8_t>(y);
    kernel.develop(row);
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
