#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "recollect/simulation/material.h"

namespace recollect::simulation {

using Vec2 = Eigen::Vector2f;
using Vec3 = Eigen::Vector3f;

// What shading needs to know of one quad. Texture coordinates are affine in the position:
// u = gu . p + u0, in tiles.
struct Surface {
  Vec3 normal = Vec3::UnitZ();
  float openness = 1;  // share of the sky it sees, 0..1; scales ambient light
  Vec3 gu = Vec3::Zero();
  float u0 = 0;
  Vec3 gv = Vec3::Zero();
  float v0 = 0;
  int material = 0;
};

// Planar quads, corners counter-clockwise seen from the front; a triangle repeats its last corner.
// Metres.
struct Mesh {
  std::vector<Vec3> vertices;
  std::vector<Vec3> normals;  // one a vertex where the mesh is smooth, else empty
  std::vector<std::array<std::uint32_t, 4>> quads;
  std::vector<Surface> surfaces;  // one a quad
};

// A thing to be placed: its opaque part and its cut-out part, whose quads each show a whole
// texture with holes: corner 0 at (0, 0), corner 2 at (1, 1).
struct Model {
  Mesh solid, cutout;
};

// Builds meshes out of simple shapes, given in a local frame and stored in the mesh's.
class MeshBuilder {
 public:
  MeshBuilder(Mesh& mesh, const Palette& palette) : mesh_(&mesh), palette_(&palette) {}

  // Rigid placing of all that follows.
  void Place(const Eigen::Isometry3f& mesh_from_local) { place_ = mesh_from_local; }
  const Eigen::Isometry3f& place() const { return place_; }
  // Material of all that follows.
  void Use(int material) { material_ = material; }
  // Shift of the texture in tiles, to keep neighbours from looking alike.
  void Shift(float u, float v) { shift_ = {u, v}; }
  void Openness(float share) { openness_ = share; }

  // A quad whose texture lies in its plane, at the material's scale: upright on walls, along x
  // and y on floors.
  void Quad(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
  void Triangle(const Vec3& a, const Vec3& b, const Vec3& c) { Quad(a, b, c, c); }
  // A quad that shows the part of the texture from `low` (corner a) to `high` (corner c).
  void Mapped(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec2& low,
              const Vec2& high);
  // A quad cut out of a picture that is spread over a parallelogram in its plane, given by three
  // of its corners: `origin` shows the texture's `low`, opposite it lies `high`.
  void Sheet(const std::array<Vec3, 4>& corners, const Vec3& origin, const Vec3& along,
             const Vec3& up, const Vec2& low, const Vec2& high);
  // A picture with a normal of its own at all corners: leaves that share their crown's shading.
  // Makes the mesh smooth: all its quads must be Cards.
  void Card(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& normal);

  // Axis-aligned box from `low` to `high`; without its bottom unless asked.
  void Box(const Vec3& low, const Vec3& high, bool bottom = false);
  // Tube of `sides` about the line from a to b, with its far end closed where `cap`.
  void Tube(const Vec3& a, const Vec3& b, float radius_a, float radius_b, int sides,
            bool cap = true);
  // Convex polygon in a plane, counter-clockwise from the front.
  void Polygon(const std::vector<Vec3>& corners);
  // Upright prism over a convex counter-clockwise outline, from z = low to z = high, with a top.
  void Prism(const std::vector<Vec2>& outline, float low, float high);
  // Ball squashed to the given half-axes.
  void Ball(const Vec3& centre, const Vec3& half_axes, int sides);

 private:
  void Push(const std::array<Vec3, 4>& corners, Surface surface);

  Mesh* mesh_;
  const Palette* palette_;
  Eigen::Isometry3f place_ = Eigen::Isometry3f::Identity();
  int material_ = 0;
  Vec2 shift_ = Vec2::Zero();
  float openness_ = 1;
};

// A pose on the ground: x forward along `heading` (radians from world x towards y), z up.
Eigen::Isometry3f Standing(const Vec3& foot, float heading);

}  // namespace recollect::simulation
