#pragma once

#include <array>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace recollect::matching {

// The scales of Lowe 2004, section 3: an octave's images are blurred further and further, until the
// sigma has doubled; every second pixel of that is the next octave's first image.
inline constexpr int kLayers = 3;          // an octave, of those that points are found in
inline constexpr double kBaseSigma = 1.6;  // of an octave's first image, in its pixels

// The sigma of an octave's image number `layer`, which need not be whole, in the octave's pixels.
double SigmaOf(double layer);

// An image seen at all scales. Octave 0 has twice its pixels a side.
class ScaleSpace {
 public:
  // gray: 8 bit, one channel, at least 32 x 32. The number of threads changes the time only.
  explicit ScaleSpace(const cv::Mat& gray);

  int octaves() const { return static_cast<int>(octaves_.size()); }
  // Blurred image, 32-bit floats of 0 to 255; layers 0 to kLayers + 2.
  const cv::Mat& At(int octave, int layer) const {
    return octaves_[static_cast<std::size_t>(octave)][static_cast<std::size_t>(layer)];
  }
  // Of an octave's coordinate x or y: the image's, and how many of its pixels one of the octave is.
  static double ToImage(int octave, double at) { return at * PixelSize(octave) - 0.25; }
  static double PixelSize(int octave) { return 0.5 * (1 << octave); }

 private:
  std::vector<std::array<cv::Mat, kLayers + 3>> octaves_;
};

// Gaussian blur with mirrored borders (101), cut off at three sigma. from: 32-bit floats, larger
// than that on all sides and at least 16 wide; throws Error otherwise.
void Blur(const cv::Mat& from, cv::Mat& to, double sigma);

}  // namespace recollect::matching
