#pragma once

#include <opencv2/core/mat.hpp>

#include "recollect/geometry/camera.h"

namespace recollect::cnn {

// What a network sees of an image: the image is resized to image_width x image_height pixels (the
// same field of view, pixel areas scaled) and the window of width x height pixels whose first
// pixel is (left, top) is cut out.
struct Crop {
  int image_width = 0, image_height = 0;
  int left = 0, top = 0, width = 0, height = 0;

  // The paper's, always 320 x 240: of a 640 x 480 image the window x in [160, 480), y in
  // [140, 380), which leaves out car and sky. Images of any other aspect are resized so that 240
  // rows (or 320 columns) fit, and the window is put in the middle. Throws Error on empty images.
  static Crop Paper(int image_width, int image_height);

  // The compact network's: all columns and the middle rows, resized to about 60,000 pixels with
  // both sides multiples of 16; 320 x 192 of a 4:3 image. Throws Error where the aspect is beyond
  // 1:8 or 8:1.
  static Crop Compact(int image_width, int image_height);

  // The window of an image of the aspect that this crop was made for (any size of it), 8 bit,
  // 3 channels; gray images are repeated. Throws Error naming `name` where the aspect differs by
  // more than 2 %, or the type is another one.
  cv::Mat Apply(const cv::Mat& image, const std::string& name = "image") const;

  // The camera that takes the window. Throws Error on another aspect, as above.
  PinholeCamera Apply(const PinholeCamera& camera) const;

  bool operator==(const Crop&) const = default;
};

}  // namespace recollect::cnn
