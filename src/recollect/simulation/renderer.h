#pragma once

#include <array>
#include <vector>

#include "recollect/geometry/camera.h"
#include "recollect/geometry/se3.h"
#include "recollect/simulation/scene.h"
#include "recollect/simulation/sky.h"

namespace recollect::simulation {

// What a perfect camera would see: no exposure, no noise.
struct Rendering {
  int width = 0, height = 0;
  std::array<std::vector<float>, 3> light;  // R, G, B; linear, row by row
  std::vector<float> depth;  // metres along the camera's z axis at the pixel's centre; 0: sky

  float Depth(int x, int y) const { return depth[Index(x, y)]; }
  std::size_t Index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
};

// A camera at a place. With a rolling shutter its lowest row is taken at world_from_camera_last;
// give both the same pose for a global one.
struct View {
  PinholeCamera camera;
  SE3 world_from_camera, world_from_camera_last;
};

// Renders one view: one ray a pixel with its shadow ray, two more where outlines would show
// steps. One thread; call it from as many as you like. `movers` may be null.
Rendering Render(const Scene& scene, const PictureSet& pictures, const Sky& sky, float wetness,
                 const View& view, const Movers* movers);

}  // namespace recollect::simulation
