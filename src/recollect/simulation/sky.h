#pragma once

#include "recollect/simulation/day.h"
#include "recollect/simulation/pictures.h"

namespace recollect::simulation {

// The light of a day. Radiances are relative: a white surface square to the noon sun is near 3.
class Sky {
 public:
  Sky(const Day& day, const PictureSet& pictures);

  // Radiance from direction `d` (unit, z up), clouds included; below the horizon that of the haze.
  Color Radiance(const Vec3& d) const;
  // What a mirror would show in direction `d`: sky, or a dim skyline and ground.
  Color Reflection(const Vec3& d) const;
  // Light from the whole sky and ground on a surface with normal `n`.
  Color Ambient(const Vec3& n) const {
    return ambient_middle_ + ambient_slope_ * n.z() +
           ambient_sunward_ * std::max(0.0F, n.dot(side_));
  }
  // Light of the unobstructed sun on a surface square to it.
  const Color& sun() const { return sun_; }
  const Vec3& to_sun() const { return to_sun_; }
  // What distance does to colour: result = colour * share + Haze(d) * (1 - share).
  float HazeShare(float distance) const { return std::exp(-distance * haze_); }
  Color Haze(const Vec3& d) const;

 private:
  const Texture* noise_;
  Vec3 to_sun_, side_;  // side_: horizontally towards the sun
  Color sun_, zenith_, horizon_, cloud_light_, cloud_dark_;
  Color ambient_middle_, ambient_slope_, ambient_sunward_;
  float cover_, haze_, drift_u_, drift_v_;
};

}  // namespace recollect::simulation
