#pragma once

#include <vector>

#include "recollect/simulation/mesh.h"

namespace recollect::simulation {

// A model at its place.
struct Instance {
  int model = 0;
  Eigen::Affine3f world_from_model = Eigen::Affine3f::Identity();  // rotation, one scale, shift
  Color tint = Color::Ones();  // of the model's repaintable and leafy parts
};

// Everything that stands still on one day.
struct World {
  Palette palette;
  Mesh solid, cutout;  // what is there once: ground, roads, buildings, fences
  std::vector<Model> models;
  std::vector<Instance> instances;

  int AddModel(Model model) {
    models.push_back(std::move(model));
    return static_cast<int>(models.size()) - 1;
  }
};

}  // namespace recollect::simulation
