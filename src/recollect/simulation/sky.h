#pragma once

#include "recollect/simulation/day.h"
#include "recollect/simulation/packet.h"

namespace recollect::simulation {

// The light of a day. Radiances are relative: a white surface square to the noon sun is near 3.
class Sky {
 public:
  explicit Sky(const Day& day);

  const SkyLight& light() const { return light_; }
  // Whether the sun casts shadows: it is up, and not behind closed clouds.
  bool shadows() const { return shadows_; }

 private:
  SkyLight light_{};
  bool shadows_ = false;
};

}  // namespace recollect::simulation
