#include "recollect/matching/points.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core/utility.hpp>
#include <optional>
#include <tuple>

#include "recollect/matching/variants.h"

namespace recollect::matching {
namespace {

constexpr int kDifferences = kLayers + 2;  // an octave's
constexpr int kBorder = 5;                 // pixels at an image's sides where no points are
constexpr float kEdgeRatio = 10;           // of the two curvatures
constexpr int kMoves = 5;                  // of an extremum until it lies within its pixel
constexpr int kStripe = 16;                // rows that one task looks at

RECOLLECT_VARIANTS
void Subtract(const float* a, const float* b, int width, float* out) {
  for (int x = 0; x < width; ++x) out[x] = a[x] - b[x];
}

// The least of three rows at each x, and the most.
RECOLLECT_VARIANTS
void Least(const float* a, const float* b, const float* c, int width, float* out) {
  for (int x = 0; x < width; ++x) out[x] = std::min(a[x], std::min(b[x], c[x]));
}
RECOLLECT_VARIANTS
void Most(const float* a, const float* b, const float* c, int width, float* out) {
  for (int x = 0; x < width; ++x) out[x] = std::max(a[x], std::max(b[x], c[x]));
}

// hits[x]: whether `here` is the least or the most of all around it, and not almost nothing.
RECOLLECT_VARIANTS
void MarkExtrema(const float* here, const float* least, const float* most, int width, float weak,
                 int* hits) {
  for (int x = 1; x < width - 1; ++x) {
    const float up = std::max(most[x], std::max(most[x - 1], most[x + 1]));
    const float down = std::min(least[x], std::min(least[x - 1], least[x + 1]));
    const int above = static_cast<int>(here[x] >= up) & static_cast<int>(here[x] > weak);
    const int below = static_cast<int>(here[x] <= down) & static_cast<int>(here[x] < -weak);
    hits[x] = above | below;
  }
}

// At `from` or after it; hits.size() where there is none.
int FirstHit(const std::vector<int>& hits, int from) {
  return static_cast<int>(std::find(hits.begin() + from, hits.end(), 1) - hits.begin());
}

// The quadric through the differences around a pixel tells where between the pixels and scales the
// extremum lies.
class Quadric {
 public:
  Quadric(const ScaleSpace& space, int octave, int layer, int y, int x) {
    const auto d = [&](int dl, int dy, int dx) {
      return space.At(octave, layer + dl + 1).at<float>(y + dy, x + dx) -
             space.At(octave, layer + dl).at<float>(y + dy, x + dx);
    };
    value_ = d(0, 0, 0);
    gradient_ << d(0, 0, 1) - d(0, 0, -1), d(0, 1, 0) - d(0, -1, 0), d(1, 0, 0) - d(-1, 0, 0);
    gradient_ *= 0.5f;
    const float xx = d(0, 0, 1) + d(0, 0, -1) - 2 * value_;
    const float yy = d(0, 1, 0) + d(0, -1, 0) - 2 * value_;
    const float ss = d(1, 0, 0) + d(-1, 0, 0) - 2 * value_;
    const float xy = 0.25f * (d(0, 1, 1) - d(0, 1, -1) - d(0, -1, 1) + d(0, -1, -1));
    const float xs = 0.25f * (d(1, 0, 1) - d(1, 0, -1) - d(-1, 0, 1) + d(-1, 0, -1));
    const float ys = 0.25f * (d(1, 1, 0) - d(1, -1, 0) - d(-1, 1, 0) + d(-1, -1, 0));
    hessian_ << xx, xy, xs, xy, yy, ys, xs, ys, ss;
  }

  Eigen::Vector3f Peak() const { return -hessian_.partialPivLu().solve(gradient_); }
  float ValueAt(const Eigen::Vector3f& offset) const {
    return value_ + 0.5f * gradient_.dot(offset);
  }
  bool IsEdge() const {
    const float trace = hessian_(0, 0) + hessian_(1, 1);
    const float determinant = hessian_(0, 0) * hessian_(1, 1) - hessian_(0, 1) * hessian_(0, 1);
    return determinant <= 0 ||
           trace * trace * kEdgeRatio >= (kEdgeRatio + 1) * (kEdgeRatio + 1) * determinant;
  }

 private:
  float value_;
  Eigen::Vector3f gradient_;
  Eigen::Matrix3f hessian_;
};

std::optional<ScalePoint> Locate(const ScaleSpace& space, int octave, int layer, int y, int x,
                                 float contrast) {
  const cv::Size size = space.At(octave, 0).size();
  for (int move = 0; move < kMoves; ++move) {
    const Quadric quadric(space, octave, layer, y, x);
    const Eigen::Vector3f offset = quadric.Peak();
    if (!(offset.cwiseAbs().maxCoeff() < static_cast<float>(size.width))) return std::nullopt;
    if (offset.cwiseAbs().maxCoeff() < 0.5f) {
      const float value = std::abs(quadric.ValueAt(offset)) / 255;
      if (value * kLayers < contrast || quadric.IsEdge()) return std::nullopt;
      const auto at = static_cast<float>(layer) + offset.z();
      return ScalePoint{octave,
                        layer,
                        static_cast<float>(x) + offset.x(),
                        static_cast<float>(y) + offset.y(),
                        static_cast<float>(SigmaOf(at)),
                        value};
    }
    x += static_cast<int>(std::lround(offset.x()));
    y += static_cast<int>(std::lround(offset.y()));
    layer += static_cast<int>(std::lround(offset.z()));
    if (layer < 1 || layer > kLayers || x < kBorder || x >= size.width - kBorder || y < kBorder ||
        y >= size.height - kBorder) {
      return std::nullopt;
    }
  }
  return std::nullopt;
}

// One row of floats for each layer of differences.
class Rows {
 public:
  explicit Rows(int width)
      : width_(width), values_(static_cast<std::size_t>(kDifferences * width)) {}
  float* At(int layer) { return values_.data() + static_cast<std::ptrdiff_t>(layer) * width_; }

 private:
  int width_;
  std::vector<float> values_;
};

// Of the rows from `first` to before `last`.
std::vector<ScalePoint> FindInStripe(const ScaleSpace& space, int octave, int first, int last,
                                     float contrast) {
  std::vector<ScalePoint> points;
  const int width = space.At(octave, 0).cols;
  const auto size = static_cast<std::size_t>(width);
  // What is less than half of what is asked for will not be more between the pixels.
  const float weak = 0.5f * contrast * 255 / kLayers;
  std::array<Rows, 3> ring = {Rows(width), Rows(width), Rows(width)};  // by y modulo three
  Rows least(width), most(width);
  std::vector<float> low(size), high(size);
  std::vector<int> hits(size);
  const auto row = [&](int y, int layer) {
    return ring[static_cast<std::size_t>(y % 3)].At(layer);
  };
  for (int next = first - 1; next <= last; ++next) {
    for (int layer = 0; layer < kDifferences; ++layer) {
      Subtract(space.At(octave, layer + 1).ptr<float>(next),
               space.At(octave, layer).ptr<float>(next), width, row(next, layer));
    }
    const int y = next - 1;
    if (y < first) continue;
    for (int layer = 0; layer < kDifferences; ++layer) {
      const float *above = row(y - 1, layer), *here = row(y, layer), *below = row(next, layer);
      Least(above, here, below, width, least.At(layer));
      Most(above, here, below, width, most.At(layer));
    }
    for (int layer = 1; layer <= kLayers; ++layer) {
      Least(least.At(layer - 1), least.At(layer), least.At(layer + 1), width, low.data());
      Most(most.At(layer - 1), most.At(layer), most.At(layer + 1), width, high.data());
      MarkExtrema(row(y, layer), low.data(), high.data(), width, weak, hits.data());
      for (int x = FirstHit(hits, kBorder); x < width - kBorder; x = FirstHit(hits, x + 1)) {
        const auto point = Locate(space, octave, layer, y, x, contrast);
        if (point) points.push_back(*point);
      }
    }
  }
  return points;
}

}  // namespace

std::vector<ScalePoint> FindPoints(const ScaleSpace& space, double contrast) {
  struct Stripe {
    int octave, first, last;
    std::vector<ScalePoint> points;
  };
  std::vector<Stripe> stripes;
  for (int octave = 0; octave < space.octaves(); ++octave) {
    const int end = space.At(octave, 0).rows - kBorder;
    for (int y = kBorder; y < end; y += kStripe) {
      stripes.push_back({octave, y, std::min(y + kStripe, end), {}});
    }
  }
  cv::parallel_for_({0, static_cast<int>(stripes.size())}, [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) {
      Stripe& s = stripes[static_cast<std::size_t>(i)];
      s.points = FindInStripe(space, s.octave, s.first, s.last, static_cast<float>(contrast));
    }
  });
  std::vector<ScalePoint> points;
  for (const Stripe& s : stripes) points.insert(points.end(), s.points.begin(), s.points.end());
  const auto order = [](const ScalePoint& p) {
    return std::tuple(-p.contrast, p.octave, p.x, p.y, p.sigma);
  };
  std::sort(points.begin(), points.end(),
            [&](const ScalePoint& a, const ScalePoint& b) { return order(a) < order(b); });
  // Neighbouring pixels may lead to one extremum.
  points.erase(
      std::unique(points.begin(), points.end(),
                  [&](const ScalePoint& a, const ScalePoint& b) { return order(a) == order(b); }),
      points.end());
  return points;
}

}  // namespace recollect::matching
