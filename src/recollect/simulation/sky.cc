#include "recollect/simulation/sky.h"

#include <algorithm>
#include <cmath>

#include "recollect/simulation/noise.h"

namespace recollect::simulation {
namespace {

Color Mix(const Color& a, const Color& b, float t) { return a * (1 - t) + b * t; }

// Share of sunlight that reaches the ground, by colour, after a path through `mass` atmospheres.
Color Transmittance(float mass) { return (Color(-0.075F, -0.15F, -0.30F) * mass).exp(); }

}  // namespace

Sky::Sky(const Day& day, const PictureSet& pictures)
    : noise_(&pictures.variation()),
      to_sun_(day.to_sun),
      cover_(day.cloud),
      haze_(3.0F / day.visibility),
      drift_u_(static_cast<float>(day.Draw(11))),
      drift_v_(static_cast<float>(day.Draw(12))) {
  const float height = std::asin(std::clamp(to_sun_.z(), -1.0F, 1.0F));  // radians
  const float mass = 1 / (std::max(0.0F, to_sun_.z()) + 0.05F);
  const float up = SmoothStep(-0.03F, 0.03F, height);
  side_ = Vec3(to_sun_.x(), to_sun_.y(), 0).normalized();
  // Thick cloud takes the sun away; a fair sky's clouds only dim it a little.
  const float through = 1 - 0.97F * SmoothStep(0.6F, 0.92F, cover_);
  sun_ = 4.2F * Transmittance(mass) * up * through;

  const float light = 0.03F + 0.97F * SmoothStep(-0.15F, 0.25F, height);  // dusk to day
  const float low = 1 - SmoothStep(0.0F, 0.5F, height);  // how much the sun is near the horizon
  const Color clear_zenith = Mix({0.16F, 0.33F, 0.78F}, {0.16F, 0.25F, 0.52F}, low) * light;
  const Color clear_horizon = Mix({0.72F, 0.88F, 1.1F}, {1.0F, 0.72F, 0.48F}, low * 0.8F) * light;
  const Color gray = Color(0.62F, 0.65F, 0.70F) * light * (day.wetness > 0.5F ? 0.7F : 1.0F);
  const float cloudy = SmoothStep(0.5F, 0.95F, cover_);
  zenith_ = Mix(clear_zenith, gray, cloudy);
  horizon_ = Mix(clear_horizon, gray * 1.15F, cloudy);
  cloud_light_ = Mix(Color(1.5F, 1.48F, 1.45F) * light, sun_ * 0.35F + gray, 0.5F);
  cloud_dark_ = Mix(Color(0.68F, 0.70F, 0.75F) * light, gray * 0.75F, cloudy);

  const float white = 0.35F * std::min(cover_, 0.8F);
  const Color dome = Mix(Mix(zenith_, horizon_, 0.4F), cloud_light_, white);
  const Color ground = 0.14F * (sun_ * std::max(0.0F, to_sun_.z()) + dome);
  ambient_middle_ = (dome + ground) * 0.5F;
  ambient_slope_ = (dome - ground) * 0.5F;
  ambient_sunward_ = horizon_ * 0.18F;
}

Color Sky::Radiance(const Vec3& d) const {
  const float z = std::max(d.z(), 0.0F);
  const float low = (1 - z) * (1 - z);
  const float rise = 1 - low * low;
  Color color = Mix(horizon_, zenith_, rise);
  const float toward = std::max(0.0F, d.dot(to_sun_));
  const float toward2 = toward * toward, toward4 = toward2 * toward2;
  const float toward16 = toward4 * toward4 * toward4 * toward4;
  color += sun_ * (0.04F * toward4 + 0.12F * toward16 * toward16 * toward16);
  if (cover_ > 0.02F && z > 0.01F) {
    const float reach = 0.11F / (z + 0.12F);
    const float u = d.x() * reach + drift_u_, v = d.y() * reach + drift_v_;
    const Color big = noise_->Smooth(u, v, 0.003F);
    const Color small = noise_->Smooth(u * 4.3F, v * 4.3F, 0.004F);
    const float density = 0.68F * big.x() + 0.32F * small.y();
    const float edge = 1 - cover_;
    const float alpha =
        SmoothStep(edge - 0.08F, edge + 0.22F, density) * SmoothStep(0.01F, 0.1F, z);
    const float thick = SmoothStep(edge + 0.05F, edge + 0.5F, density);
    color = Mix(color, Mix(cloud_light_, cloud_dark_, thick), alpha);
  }
  if (toward > 0.99998F) color += sun_ * 60;
  return color;
}

Color Sky::Reflection(const Vec3& d) const {
  // A skyline of trees and roofs that nobody can tell from the true one in a window pane.
  const float ridge = 0.10F + 0.12F * std::sin(d.x() * 9 + 2 * d.y()) * std::sin(d.y() * 7 + 1);
  const Color dim = (ambient_middle_ + sun_ * 0.08F) * Color(0.16F, 0.2F, 0.13F);
  const float t = SmoothStep(ridge - 0.02F, ridge + 0.03F, d.z());
  return t > 0 ? Mix(dim, Radiance(d), t) : dim;
}

Color Sky::Haze(const Vec3& d) const {
  const float toward = std::max(0.0F, d.dot(to_sun_));
  return horizon_ * 0.9F + sun_ * 0.05F * toward * toward * toward * toward;
}

}  // namespace recollect::simulation
