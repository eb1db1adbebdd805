#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace recollect::matching {

// Bytes of one descriptor: SIFT's 128 gradient bins, each 0..127.
inline constexpr int kDescriptorBytes = 128;

struct FeatureOptions {
  int count = 800;          // at most so many, the strongest
  double resolution = 0.5;  // of the image in which the finest features lie
  double clahe = 3;         // clip limit of the contrast normalisation; 0: none
  double contrast = 0.003;  // weaker extrema are dropped
};

// Points of an image that other images of the same place show, too: upright SIFT (Lowe 2004) on a
// contrast-normalised image, descriptors as RootSIFT (Arandjelovic and Zisserman 2012). Upright,
// because vehicles are, and half the resolution, because coarse features outlive a change of light
// (figures: docs/geometry.md).
struct Features {
  std::vector<Eigen::Vector2d> pixels;
  std::vector<float> sizes;              // diameter in pixels of the image
  std::vector<std::int8_t> descriptors;  // kDescriptorBytes each
  int size() const { return static_cast<int>(pixels.size()); }
  const std::int8_t* Descriptor(int i) const { return descriptors.data() + i * kDescriptorBytes; }
};

// gray: 8 bit, one channel; throws Error otherwise. Strongest first, the same on every run.
Features FindFeatures(const cv::Mat& gray, const FeatureOptions& options = {});

// An 8-bit image, B, G, R or gray, as gray.
cv::Mat ToGray(const cv::Mat& image);

}  // namespace recollect::matching
