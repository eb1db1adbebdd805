#include "recollect/simulation/site.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "recollect/core/error.h"
#include "recollect/simulation/noise.h"

namespace recollect::simulation {
namespace {

constexpr float kMargin = 220;    // land around the streets, metres
constexpr float kCell = 0.5F;     // of the maps of clearance and claims
constexpr float kCoarse = 4;      // of the height map
constexpr float kCarRoom = 1.4F;  // kept free to either side of every drive

float Bilinear(const cv::Mat1f& map, float x, float y) {
  const float cx = std::clamp(x, 0.0F, static_cast<float>(map.cols - 1) - 1e-3F);
  const float cy = std::clamp(y, 0.0F, static_cast<float>(map.rows - 1) - 1e-3F);
  const int i = static_cast<int>(cx), j = static_cast<int>(cy);
  const float u = cx - static_cast<float>(i), v = cy - static_cast<float>(j);
  return (map(j, i) * (1 - u) + map(j, i + 1) * u) * (1 - v) +
         (map(j + 1, i) * (1 - u) + map(j + 1, i + 1) * u) * v;
}

// Heights of the stations spread over the land: means weighted by nearness, from a coarse bucket
// map blurred at growing widths until every place is covered.
cv::Mat1f SpreadHeights(const std::vector<Street>& streets, const Vec2& low, cv::Size size) {
  cv::Mat1f sum(size, 0.0F), weight(size, 0.0F);
  for (const Street& street : streets) {
    for (const Street::Station& s : street.stations) {
      const int i = static_cast<int>((s.middle.x() - low.x()) / kCoarse + 0.5F);
      const int j = static_cast<int>((s.middle.y() - low.y()) / kCoarse + 0.5F);
      sum(j, i) += s.middle.z();
      weight(j, i) += 1;
    }
  }
  cv::Mat1f height(size, 0.0F), left(size, 1.0F);
  for (const double sigma : {3.0, 12.0, 48.0}) {
    cv::Mat1f s, w;
    cv::GaussianBlur(sum, s, {}, sigma, sigma, cv::BORDER_CONSTANT);
    cv::GaussianBlur(weight, w, {}, sigma, sigma, cv::BORDER_CONSTANT);
    for (int j = 0; j < size.height; ++j) {
      for (int i = 0; i < size.width; ++i) {
        const float known = left(j, i) * std::min(1.0F, w(j, i) * 60);
        if (w(j, i) > 1e-9F) height(j, i) += known * s(j, i) / w(j, i);
        left(j, i) -= known;
      }
    }
  }
  return height;
}

}  // namespace

Site::Site(const Route& route, const std::vector<Street>& streets, std::uint64_t seed) {
  low_ = Vec2::Constant(1e9F);
  high_ = -low_;
  for (const Street& street : streets) {
    for (const auto& s : street.stations) {
      low_ = low_.cwiseMin(s.middle.head<2>());
      high_ = high_.cwiseMax(s.middle.head<2>());
    }
  }
  low_.array() -= kMargin;
  high_.array() += kMargin;
  const Vec2 extent = high_ - low_;
  Require(extent.maxCoeff() < 6000, "route",
          fmt::format("it spans {:.0f} m x {:.0f} m", extent.x(), extent.y()),
          "routes may span at most 5.5 km");

  const cv::Size cells(static_cast<int>(extent.x() / kCell), static_cast<int>(extent.y() / kCell));
  cv::Mat1b land(cells, 255);
  for (const Street& street : streets) {
    const std::size_t n = street.stations.size();
    for (std::size_t i = 0; i + (street.closed ? 0 : 1) < n; ++i) {
      const auto& a = street.stations[i];
      const auto& b = street.stations[(i + 1) % n];
      cv::fillConvexPoly(land,
                         Cells({a.middle.head<2>() - a.left * a.edge_right(),
                                b.middle.head<2>() - b.left * b.edge_right(),
                                b.middle.head<2>() + b.left * b.edge_left(),
                                a.middle.head<2>() + a.left * a.edge_left()}),
                         0);
    }
  }
  for (const Drive& drive : route.drives) {
    for (const SE3& pose : drive.world_from_car) {
      const Vec2 p = pose.translation().head<2>().cast<float>();
      cv::circle(land, Cells({p}).front(), static_cast<int>(kCarRoom / kCell), 0, cv::FILLED);
    }
  }
  cv::distanceTransform(land, clearance_, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  clearance_ *= kCell;
  taken_ = land == 0;

  const cv::Size coarse(static_cast<int>(extent.x() / kCoarse) + 1,
                        static_cast<int>(extent.y() / kCoarse) + 1);
  height_ = SpreadHeights(streets, low_, coarse);
  const auto hills = static_cast<std::uint32_t>(seed);
  for (int j = 0; j < coarse.height; ++j) {
    for (int i = 0; i < coarse.width; ++i) {
      const float x = low_.x() + kCoarse * static_cast<float>(i);
      const float y = low_.y() + kCoarse * static_cast<float>(j);
      const float far = Clearance(x, y);
      const float broad = Fbm(x / 140, y / 140, 4096, 4, hills);
      const float slopes = SmoothStep(12, 110, far) * std::max(0.0F, broad - 0.42F) * 70;
      const float mounds = SmoothStep(4, 14, far) * Fbm(x / 23, y / 23, 4096, 3, hills + 7) * 0.9F;
      height_(j, i) += slopes + mounds;
    }
  }
}

Site Site::Copy() const {
  Site copy = *this;
  copy.taken_ = taken_.clone();
  return copy;
}

float Site::Height(float x, float y) const {
  // As the ray tracer splits the land's quads: into two triangles, so that things sit flush.
  const float cx = std::clamp((x - low_.x()) / kCoarse, 0.0F, static_cast<float>(height_.cols - 2));
  const float cy = std::clamp((y - low_.y()) / kCoarse, 0.0F, static_cast<float>(height_.rows - 2));
  const int i = static_cast<int>(cx), j = static_cast<int>(cy);
  const float u = cx - static_cast<float>(i), v = cy - static_cast<float>(j);
  const float b = height_(j, i + 1), d = height_(j + 1, i);
  if (u + v <= 1) {
    const float a = height_(j, i);
    return a + u * (b - a) + v * (d - a);
  }
  const float c = height_(j + 1, i + 1);
  return c + (1 - u) * (d - c) + (1 - v) * (b - c);
}

float Site::Clearance(float x, float y) const {
  return Bilinear(clearance_, (x - low_.x()) / kCell - 0.5F, (y - low_.y()) / kCell - 0.5F);
}

std::vector<cv::Point> Site::Cells(const std::vector<Vec2>& outline) const {
  std::vector<cv::Point> points;
  for (const Vec2& p : outline) {
    points.emplace_back(static_cast<int>(std::floor((p.x() - low_.x()) / kCell)),
                        static_cast<int>(std::floor((p.y() - low_.y()) / kCell)));
  }
  return points;
}

bool Site::IsFree(const std::vector<Vec2>& outline) const {
  const auto points = Cells(outline);
  const cv::Rect box = cv::boundingRect(points);
  if ((box & cv::Rect(0, 0, taken_.cols, taken_.rows)) != box) return false;
  cv::Mat1b mask(box.size(), 0);
  std::vector<cv::Point> local;
  for (const cv::Point& p : points) local.push_back(p - box.tl());
  cv::fillConvexPoly(mask, local, 255);
  return cv::countNonZero(mask & taken_(box)) == 0;
}

void Site::Take(const std::vector<Vec2>& outline) {
  cv::fillConvexPoly(taken_, Cells(outline), 255);
}

bool Site::Claim(const std::vector<Vec2>& outline) {
  if (!IsFree(outline)) return false;
  Take(outline);
  return true;
}

std::vector<Vec2> Rectangle(const Vec2& centre, float heading, float along, float across) {
  const Vec2 x = Vec2(std::cos(heading), std::sin(heading)) * along / 2;
  const Vec2 y = Vec2(-std::sin(heading), std::cos(heading)) * across / 2;
  return {centre - x - y, centre + x - y, centre + x + y, centre - x + y};
}

}  // namespace recollect::simulation
