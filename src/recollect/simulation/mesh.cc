#include "recollect/simulation/mesh.h"

#include <cmath>
#include <numbers>

namespace recollect::simulation {

void MeshBuilder::Push(const std::array<Vec3, 4>& corners, Surface surface) {
  const auto base = static_cast<std::uint32_t>(mesh_->vertices.size());
  for (const Vec3& corner : corners) mesh_->vertices.push_back(place_ * corner);
  mesh_->quads.push_back({base, base + 1, base + 2, base + 3});
  const Eigen::Matrix3f R = place_.rotation();
  const Vec3 t = place_.translation();
  surface.normal = R * surface.normal;
  surface.gu = R * surface.gu;
  surface.gv = R * surface.gv;
  surface.u0 -= surface.gu.dot(t);
  surface.v0 -= surface.gv.dot(t);
  surface.openness = openness_;
  surface.material = material_;
  mesh_->surfaces.push_back(surface);
}

void MeshBuilder::Quad(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  Surface s;
  s.normal = (c - a).cross(d == c ? Vec3(c - b) : Vec3(d - b)).normalized();
  if (d == c) s.normal = (b - a).cross(c - a).normalized();
  const float scale = 1.0F / (*palette_)[material_].tile;
  const Vec3 level = Vec3::UnitZ().cross(s.normal);
  if (level.squaredNorm() < 0.25F) {
    s.gu = Vec3::UnitX() * scale;
    s.gv = Vec3::UnitY() * scale;
  } else {
    s.gu = level.normalized() * scale;
    s.gv = s.normal.cross(level).normalized() * scale;
  }
  s.u0 = shift_.x();
  s.v0 = shift_.y();
  Push({a, b, c, d}, s);
}

void MeshBuilder::Mapped(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d,
                         const Vec2& low, const Vec2& high) {
  Sheet({a, b, c, d}, a, b, d, low, high);
}

void MeshBuilder::Sheet(const std::array<Vec3, 4>& corners, const Vec3& origin,
                        const Vec3& along_to, const Vec3& up_to, const Vec2& low,
                        const Vec2& high) {
  Surface s;
  const Vec3 along = along_to - origin, up = up_to - origin;
  s.normal = along.cross(up).normalized();
  // The dual basis of (along, up) in the plane: exact for parallelograms.
  const Vec3 du = up.cross(s.normal), dv = s.normal.cross(along);
  s.gu = du / du.dot(along) * (high.x() - low.x());
  s.gv = dv / dv.dot(up) * (high.y() - low.y());
  s.u0 = low.x() - s.gu.dot(origin);
  s.v0 = low.y() - s.gv.dot(origin);
  Push(corners, s);
}

void MeshBuilder::Card(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d,
                       const Vec3& normal) {
  Mapped(a, b, c, d, {0, 0}, {1, 1});
  for (int i = 0; i < 4; ++i) mesh_->normals.push_back(place_.rotation() * normal.normalized());
}

void MeshBuilder::Box(const Vec3& l, const Vec3& h, bool bottom) {
  const auto corner = [&](int x, int y, int z) {
    return Vec3(x ? h.x() : l.x(), y ? h.y() : l.y(), z ? h.z() : l.z());
  };
  Quad(corner(1, 0, 0), corner(1, 1, 0), corner(1, 1, 1), corner(1, 0, 1));
  Quad(corner(0, 1, 0), corner(0, 0, 0), corner(0, 0, 1), corner(0, 1, 1));
  Quad(corner(1, 1, 0), corner(0, 1, 0), corner(0, 1, 1), corner(1, 1, 1));
  Quad(corner(0, 0, 0), corner(1, 0, 0), corner(1, 0, 1), corner(0, 0, 1));
  Quad(corner(0, 0, 1), corner(1, 0, 1), corner(1, 1, 1), corner(0, 1, 1));
  if (bottom) Quad(corner(0, 1, 0), corner(1, 1, 0), corner(1, 0, 0), corner(0, 0, 0));
}

void MeshBuilder::Tube(const Vec3& a, const Vec3& b, float radius_a, float radius_b, int sides,
                       bool cap) {
  const Vec3 axis = (b - a).normalized();
  const Vec3 x =
      (std::abs(axis.z()) < 0.9F ? Vec3::UnitZ() : Vec3::UnitX()).cross(axis).normalized();
  const Vec3 y = axis.cross(x);
  const auto rim = [&](int i) {
    const float angle =
        2 * std::numbers::pi_v<float> * static_cast<float>(i % sides) / static_cast<float>(sides);
    return Vec3(x * std::cos(angle) + y * std::sin(angle));
  };
  std::vector<Vec3> top;
  for (int i = 0; i < sides; ++i) {
    const Vec3 r0 = rim(i), r1 = rim(i + 1);
    Quad(a + r0 * radius_a, a + r1 * radius_a, b + r1 * radius_b, b + r0 * radius_b);
    top.push_back(b + r0 * radius_b);
  }
  if (cap && radius_b > 0) Polygon(top);
}

void MeshBuilder::Polygon(const std::vector<Vec3>& corners) {
  for (std::size_t i = 1; i + 1 < corners.size(); i += 2) {
    const Vec3& last = i + 2 < corners.size() ? corners[i + 2] : corners[i + 1];
    Quad(corners[0], corners[i], corners[i + 1], last);
  }
}

void MeshBuilder::Prism(const std::vector<Vec2>& outline, float low, float high) {
  std::vector<Vec3> top;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec2& p = outline[i];
    const Vec2& q = outline[(i + 1) % outline.size()];
    Quad({p.x(), p.y(), low}, {q.x(), q.y(), low}, {q.x(), q.y(), high}, {p.x(), p.y(), high});
    top.emplace_back(p.x(), p.y(), high);
  }
  Polygon(top);
}

void MeshBuilder::Ball(const Vec3& centre, const Vec3& half_axes, int sides) {
  const int rings = std::max(3, sides / 2);
  const auto point = [&](int ring, int side) {
    const float lat =
        std::numbers::pi_v<float> * (static_cast<float>(ring) / static_cast<float>(rings) - 0.5F);
    const float lon = 2 * std::numbers::pi_v<float> * static_cast<float>(side % sides) /
                      static_cast<float>(sides);
    const Vec3 unit(std::cos(lat) * std::cos(lon), std::cos(lat) * std::sin(lon), std::sin(lat));
    return Vec3(centre + unit.cwiseProduct(half_axes));
  };
  for (int r = 0; r < rings; ++r) {
    for (int s = 0; s < sides; ++s) {
      if (r == 0) {
        Triangle(point(0, 0), point(1, s + 1), point(1, s));
      } else if (r + 1 == rings) {
        Triangle(point(r, s), point(r, s + 1), point(rings, 0));
      } else {
        Quad(point(r, s), point(r, s + 1), point(r + 1, s + 1), point(r + 1, s));
      }
    }
  }
}

Eigen::Isometry3f Standing(const Vec3& foot, float heading) {
  Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
  pose.linear() = Eigen::AngleAxisf(heading, Vec3::UnitZ()).toRotationMatrix();
  pose.translation() = foot;
  return pose;
}

}  // namespace recollect::simulation
