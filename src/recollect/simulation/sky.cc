#include "recollect/simulation/sky.h"

#include <algorithm>
#include <cmath>

#include "recollect/simulation/noise.h"

namespace recollect::simulation {
namespace {

Color Mix(const Color& a, const Color& b, float t) { return a * (1 - t) + b * t; }

// Share of sunlight that reaches the ground, by colour, after a path through `mass` atmospheres.
Color Transmittance(float mass) { return (Color(-0.075F, -0.15F, -0.30F) * mass).exp(); }

template <typename Triple>
void Keep(const Triple& from, float* to) {
  for (int k = 0; k < 3; ++k) to[k] = from[k];
}

}  // namespace

Sky::Sky(const Day& day) {
  const Vec3& to_sun = day.to_sun;
  const float height = std::asin(std::clamp(to_sun.z(), -1.0F, 1.0F));  // radians
  const float mass = 1 / (std::max(0.0F, to_sun.z()) + 0.05F);
  const float up = SmoothStep(-0.03F, 0.03F, height);
  // Thick cloud takes the sun away; a fair sky's clouds only dim it a little.
  const float through = 1 - 0.97F * SmoothStep(0.6F, 0.92F, day.cloud);
  const Color sun = 4.2F * Transmittance(mass) * up * through;

  const float light = 0.03F + 0.97F * SmoothStep(-0.15F, 0.25F, height);  // dusk to day
  const float low = 1 - SmoothStep(0.0F, 0.5F, height);  // how much the sun is near the horizon
  const Color clear_zenith = Mix({0.16F, 0.33F, 0.78F}, {0.16F, 0.25F, 0.52F}, low) * light;
  const Color clear_horizon = Mix({0.72F, 0.88F, 1.1F}, {1.0F, 0.72F, 0.48F}, low * 0.8F) * light;
  const Color gray = Color(0.62F, 0.65F, 0.70F) * light * (day.wetness > 0.5F ? 0.7F : 1.0F);
  const float cloudy = SmoothStep(0.5F, 0.95F, day.cloud);
  const Color zenith = Mix(clear_zenith, gray, cloudy);
  const Color horizon = Mix(clear_horizon, gray * 1.15F, cloudy);
  const Color cloud_light = Mix(Color(1.5F, 1.48F, 1.45F) * light, sun * 0.35F + gray, 0.5F);
  const Color cloud_dark = Mix(Color(0.68F, 0.70F, 0.75F) * light, gray * 0.75F, cloudy);

  const float white = 0.35F * std::min(day.cloud, 0.8F);
  const Color dome = Mix(Mix(zenith, horizon, 0.4F), cloud_light, white);
  const Color ground = 0.14F * (sun * std::max(0.0F, to_sun.z()) + dome);
  Keep(to_sun, light_.to_sun);
  Keep(Vec3(to_sun.x(), to_sun.y(), 0).normalized(), light_.side);
  Keep(sun, light_.sun);
  Keep(zenith, light_.zenith);
  Keep(horizon, light_.horizon);
  Keep(cloud_light, light_.cloud_light);
  Keep(cloud_dark, light_.cloud_dark);
  Keep((dome + ground) * 0.5F, light_.ambient_middle);
  Keep((dome - ground) * 0.5F, light_.ambient_slope);
  Keep(horizon * 0.18F, light_.ambient_sunward);
  light_.cover = day.cloud;
  light_.haze = 3.0F / day.visibility;
  light_.drift_u = static_cast<float>(day.Draw(11));
  light_.drift_v = static_cast<float>(day.Draw(12));
  // What light comes through closed clouds comes from all of them.
  shadows_ = through > 0.05F && sun.maxCoeff() > 1e-3F;
}

}  // namespace recollect::simulation
