#pragma once

#include <memory>

#include "recollect/core/parallel.h"
#include "recollect/simulation/campus.h"
#include "recollect/simulation/faults.h"
#include "recollect/simulation/film.h"
#include "recollect/simulation/scene.h"
#include "recollect/simulation/simulate.h"
#include "recollect/simulation/traffic.h"

namespace recollect::simulation {

// The pictures of one lap: its day, its world and its camera.
class LapRenderer {
 public:
  // The arguments must outlive it. Building takes a second or two for a campus of 3.6 km.
  LapRenderer(const Campus& campus, const PictureSet& pictures, const Drive& drive, const Day& day,
              const SimulateOptions& options);

  struct Shot {
    cv::Mat left, right, depth;  // right and depth are empty unless asked for
  };
  // The pictures at pose `index` of the drive. Thread-safe; each shot depends on its index alone.
  // `gain` multiplies the exposure.
  Shot Take(std::size_t index, float gain = 1) const;

  SE3 WorldFromCamera(std::size_t index) const {
    return drive_.world_from_car[index] * car_from_camera_;
  }
  const StereoCamera& camera() const { return camera_; }
  // Share of the sky that is free above a point.
  double OpenSky(const Eigen::Vector3d& at) const;

 private:
  const PictureSet& pictures_;
  const Drive& drive_;
  const Day& day_;
  const SimulateOptions& options_;
  StereoCamera camera_;
  SE3 car_from_camera_;
  CampusDay campus_day_;
  Scene scene_;
  Sky sky_;
  Film film_;
  Traffic traffic_;
};

}  // namespace recollect::simulation
