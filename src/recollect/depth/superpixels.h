#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace recollect::stereo {

// Disparity as a linear function of the pixel: a x + b y + c.
struct Plane {
  double a = 0, b = 0, c = 0;
  double At(double x, double y) const { return a * x + b * y + c; }
};

// What a pixel's place in a superpixel costs. Colours are 8-bit Lab, positions are in units of a
// superpixel's side, disparities in px.
struct SegmentWeights {
  double position = 500;    // of the squared distance from the superpixel's centre
  double disparity = 2000;  // of the squared distance from its plane, up to the threshold
  double boundary = 1000;   // of each of the 8 neighbours in another superpixel
  double inlier_px = 3;     // the threshold
};

// A partition of an image into 4-connected superpixels. It begins as a grid; pixels at boundaries
// then move between neighbours, and none moves that would cut its superpixel in two or use it up.
class Superpixels {
 public:
  // lab: rows x cols of 8-bit Lab. disparity: 32-bit float, negative where unknown. count: about so
  // many superpixels. Both images are kept by reference.
  Superpixels(const cv::Mat& lab, const cv::Mat& disparity, int count,
              const SegmentWeights& weights);

  // Lets pixels move until no single move helps, at most `rounds` looks at each pixel on average of
  // the boundary. planes: one a superpixel; empty: disparities do not count.
  void Move(const std::vector<Plane>& planes, int rounds);

  int count() const { return static_cast<int>(sums_.size()); }
  int Label(int x, int y) const { return labels_[Index(x, y)]; }
  // rows x cols of 32-bit labels, from 0 to count() - 1.
  cv::Mat Labels() const;

 private:
  struct Sums {
    double count = 0, x = 0, y = 0;
    std::array<double, 3> colour{};
  };
  std::size_t Index(int x, int y) const {
    return static_cast<std::size_t>(y + 1) * static_cast<std::size_t>(stride_) +
           static_cast<std::size_t>(x + 1);
  }
  bool OnBoundary(std::size_t at) const;
  bool MoveBest(int x, int y, const std::vector<Plane>& planes);
  double Energy(int x, int y, int label, const std::vector<Plane>& planes) const;
  void Add(int x, int y, int label, double sign);

  const cv::Mat &lab_, &disparity_;
  SegmentWeights weights_;
  int width_, height_, stride_;
  double side_ = 1;
  std::array<std::ptrdiff_t, 8> ring_;  // from a pixel to its neighbours, clockwise from above
  std::vector<std::int32_t> labels_;    // with a border of -1
  std::vector<Sums> sums_;
};

}  // namespace recollect::stereo
