#include "recollect/simulation/lap_renderer.h"

#include <array>
#include <cmath>

namespace recollect::simulation {

LapRenderer::LapRenderer(const Campus& campus, const PictureSet& pictures, const Drive& drive,
                         const Day& day, const SimulateOptions& options)
    : pictures_(pictures),
      drive_(drive),
      day_(day),
      options_(options),
      camera_(UfesCamera()),
      car_from_camera_(UfesCarFromCamera()),
      campus_day_(BuildCampus(campus, day)),
      scene_(campus_day_.world, pictures),
      sky_(day),
      film_(LoadFilm(day)),
      traffic_(campus, campus_day_.vehicles, day, drive) {
  camera_.baseline = options.baseline;
}

LapRenderer::Shot LapRenderer::Take(std::size_t index, float gain) const {
  const double time = drive_.times[index];
  const Movers movers(scene_, traffic_.At(time));
  // How the camera moves in a second, from the poses around this one.
  const std::size_t a = index > 0 ? index - 1 : 0, b = std::min(index + 1, drive_.times.size() - 1);
  const SE3 step = WorldFromCamera(a).Inverse() * WorldFromCamera(b);
  const Vector6d rate = step.Log() / std::max(1e-3, drive_.times[b] - drive_.times[a]);
  const SE3 exposed = SE3::Exp(rate * film_.exposure);
  const SE3 read_out = SE3::Exp(rate * options_.rolling_shutter);

  const auto picture = [&](double shift, std::uint64_t eye, cv::Mat* depth) {
    const SE3 left_from_eye(Eigen::Matrix3d::Identity(), {shift, 0, 0});
    const SE3 pose = WorldFromCamera(index);
    const View view{camera_.left, pose * left_from_eye, pose * read_out * left_from_eye};
    const Rendering r = Render(scene_, pictures_, sky_, day_.wetness, view, &movers);
    if (depth != nullptr) *depth = DepthImage(r, options_.depth_step);
    return Develop(r, camera_.left, exposed, film_, SubSeed(SubSeed(day_.seed, eye), index), gain);
  };
  Shot shot;
  shot.left = picture(0, 1, options_.depth ? &shot.depth : nullptr);
  if (options_.stereo) shot.right = picture(camera_.baseline, 2, nullptr);
  return shot;
}

double LapRenderer::OpenSky(const Eigen::Vector3d& at) const {
  alignas(64) RTCRay16 rays{};
  alignas(64) std::array<int, kPacket> valid;
  valid.fill(-1);
  for (int k = 0; k < kPacket; ++k) {
    const float rise = 0.35F + 0.3F * static_cast<float>(k / 8),
                around = 0.785F * static_cast<float>(k);
    rays.org_x[k] = static_cast<float>(at.x());
    rays.org_y[k] = static_cast<float>(at.y());
    rays.org_z[k] = static_cast<float>(at.z()) + 0.3F;
    rays.dir_x[k] = std::cos(rise) * std::cos(around);
    rays.dir_y[k] = std::cos(rise) * std::sin(around);
    rays.dir_z[k] = std::sin(rise);
    rays.tfar[k] = 200;
    rays.mask[k] = ~0U;
  }
  scene_.Occluded(rays, valid.data(), nullptr);
  int open = 0;
  for (int k = 0; k < kPacket; ++k) open += rays.tfar[k] > 0 ? 1 : 0;
  return open / static_cast<double>(kPacket);
}

}  // namespace recollect::simulation
